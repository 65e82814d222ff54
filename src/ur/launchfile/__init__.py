"""Launch files: text to tree (syntax), packages and files (world), tree to plan (plan)."""

from ur.launchfile.address import resolve_addresses
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
    "load_plan",
    "resolve_addresses",
]
