"""Launch files: text to tree (syntax), packages and files (world), tree to plan (plan).

Public names are imported on first use: a query about a launch file needs half of them, and importing all would take as
long as resolving a large one.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ur.launchfile.address import resolve_addresses
    from ur.launchfile.dump import dump_plan
    from ur.launchfile.load import load_plan
    from ur.launchfile.plan.commands import CommandResult, CommandRunner, run_command, run_commands
    from ur.launchfile.plan.executables import check_executables
    from ur.launchfile.plan.specs import (
        MachineSpec,
        NodeSpec,
        Origin,
        ParamCommand,
        ParamSpec,
        ParamValue,
        Plan,
        TestSpec,
    )
    from ur.launchfile.world.memory import MemoryWorld
    from ur.launchfile.world.protocol import World
    from ur.launchfile.world.system import SystemWorld

_PLACES = {
    "resolve_addresses": "address",
    "dump_plan": "dump",
    **dict.fromkeys(("CommandResult", "CommandRunner", "run_command", "run_commands"), "plan.commands"),
    "check_executables": "plan.executables",
    "load_plan": "load",
    **dict.fromkeys(("MachineSpec", "NodeSpec", "Origin", "ParamCommand", "ParamSpec"), "plan.specs"),
    **dict.fromkeys(("ParamValue", "Plan", "TestSpec"), "plan.specs"),
    "MemoryWorld": "world.memory",
    "World": "world.protocol",
    "SystemWorld": "world.system",
}


def __getattr__(name: str) -> object:
    if name not in _PLACES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
    return value


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
