"""Launch files: text to tree (syntax), packages and files (world), tree to plan (plan)."""

from ur.launchfile.address import resolve_addresses
from ur.launchfile.dump import dump_plan
from ur.launchfile.plan.commands import CommandResult, CommandRunner, run_command, run_commands
from ur.launchfile.plan.executables import check_executables
from ur.launchfile.plan.load import load_plan
from ur.launchfile.plan.model import (
    MachineSpec,
    NodeSpec,
    Origin,
    ParamCommand,
    ParamSpec,
    ParamValue,
    Plan,
    TestSpec,
)
from ur.launchfile.world import MemoryWorld, SystemWorld, World

__all__ = [
    "CommandResult",
    "CommandRunner",
    "MachineSpec",
    "MemoryWorld",
    "NodeSpec",
    "Origin",
    "ParamCommand",
    "ParamSpec",
    "ParamValue",
    "Plan",
    "SystemWorld",
    "TestSpec",
    "World",
    "check_executables",
    "dump_plan",
    "load_plan",
    "resolve_addresses",
    "run_command",
    "run_commands",
]
