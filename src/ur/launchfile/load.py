"""Loader of launch files of both launch languages: from files and arguments to a Plan."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ur.launchfile.plan.draft import Draft
from ur.launchfile.plan.specs import MachineSpec, Plan, TraceStep
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.syntax.parse import is_ros2_name, is_ros2_tree
from ur.launchfile.world.protocol import World

if TYPE_CHECKING:
    from ur.launchfile.plan.commands import RunWith


def load_plan(
    files: Sequence[str],
    arguments: Sequence[str],
    world: World,
    trace: list[TraceStep] | None = None,
    trees: dict[str, LaunchFile] | None = None,
    computers: Sequence[MachineSpec] = (),
    budget: Budget | None = None,
    parsed: dict[str, LaunchFile] | None = None,
    run: RunWith | None = None,
) -> Plan:
    """Resolve launch files with `NAME:=VALUE` arguments, as the launcher does for which they are written.

    A file for ROS 2 is resolved alone; several files together, or with one for ROS 2, are resolved as roslaunch does,
    which refuses that one. Never raises for the content of a file or an argument: the plan's diagnostics have an error
    for all that the launcher would refuse, and warnings for mistakes that it silently accepts. Nothing is executed; see
    `run_commands` for the parameters that programs print. A `trace` receives the steps by which values resulted, in
    order. `trees` caches parsed files by absolute path; `parsed` caches them by their paths as written. `computers` are
    machines without a `<machine>` tag; a file's tag of the same name takes precedence. `budget` limits the computation
    of expressions; several loads of a file can share one. `run` runs the commands whose output is a value in a file for
    ROS 2; without it these values are gaps.
    """
    if len(files) == 1:
        parsed = {} if parsed is None else parsed
        if is_for_ros2(files[0], world, trees, parsed):
            from ur.launchfile.ros2.load import load_ros2

            return load_ros2(files[0], arguments, world, trace, run=run)
    from ur.launchfile.plan.load import load_ros1  # most arguments are read without it

    return load_ros1(files, arguments, world, trace, trees, computers, budget, parsed)


def describe_call(name: str) -> dict[str, tuple[bool, str]]:
    """Return the arguments of a class that launch files construct: whether it is required, and its type and meaning."""
    from ur.launchfile.ros2.api import describe_arguments

    return describe_arguments(name)


def is_launch_name(path: str) -> bool:
    """Return whether a file is a launch file by its name, in any language but XML."""
    return is_ros2_name(path)


def has_tree(path: str, world: World, parsed: dict[str, LaunchFile] | None = None) -> bool:
    """Return whether the arguments of a launch file are tags of a tree; those of others are known by a trace."""
    return not is_for_ros2(path, world, parsed=parsed)


def is_for_ros2(
    path: str, world: World, trees: dict[str, LaunchFile] | None = None, parsed: dict[str, LaunchFile] | None = None
) -> bool:
    """Return whether a launch file is written for ROS 2: by its name, or by the contents of one in XML."""
    if is_ros2_name(path):
        return True
    try:
        return is_ros2_tree(Draft(world, trees=trees, parsed=parsed).parse(path))
    except OSError:
        return False  # which its loader reports
