"""Packages that a launch file lacks, before its nodes start: xacro is made, the others are offered."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ur.request.options import LaunchOptions, Reporter
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic

if TYPE_CHECKING:
    from ur.request.launch_request import LaunchRequest
    from ur.request.plan_files import Inspect, Loaded

_MADE = "xacro"  # no release of Debian has it, and many a robot_description calls it


class _ReadAgainError(Exception):
    """A package has been made before the errors that name it were shown."""


def load_with_packages(
    argv: Sequence[str], selection: Selection, options: LaunchOptions, reporter: Reporter
) -> tuple[LaunchRequest, Loaded]:
    """Load what `argv` names. Errors in its files are printed, but for a missing xacro, which is made.

    Other missing packages are offered to a person, and without a terminal the command that gets them is printed.
    Raises UserError, as `load_request` does, and when xacro cannot be made.
    """
    from ur.request.environment import apply_selection
    from ur.request.joining.running import follow_world
    from ur.request.launch_request import make_request
    from ur.request.node_choice import load_chosen
    from ur.request.plan_files import make_world

    def load(inspect: Inspect | None) -> tuple[LaunchRequest, Loaded]:
        request = follow_world(make_request(argv, make_world(), selection, options))
        return request, load_chosen(request, reporter.report, inspect)

    try:
        request, loaded = load(_make_xacro_first)
    except _ReadAgainError:
        apply_selection(selection)  # its folder of packages may be new
        request, loaded = load(None)
    names = {each.subject for each in loaded.findings if each.rule == "unknown-package" and each.subject}
    if loaded.plan is None and names and "-" not in argv and offer(options, names):  # standard input is read once
        apply_selection(selection)
        request, loaded = load(None)
    return request, loaded


def _make_xacro_first(findings: Iterable[Diagnostic]) -> None:
    if any(each.rule == "unknown-package" and each.subject == _MADE for each in findings):
        make_xacro()
        raise _ReadAgainError


def make_xacro() -> None:
    """Make the ROS package xacro, recorded for `ur get --undo`. Raises UserError."""
    from ur.get.install import install
    from ur.get.model import GetPlan, Missing, Step
    from ur.get.record import record_path
    from ur.request.environment import own_packages

    sys.stderr.write("installing xacro, once ...\n")
    plan = GetPlan((Step(Missing(_MADE), "pypi", (_MADE,)),))
    install(plan, record_path(os.environ), Path(own_packages(os.environ)))


def offer(options: LaunchOptions, names: Iterable[str]) -> bool:
    """Ask whether `ur get` should look for packages, and run it; True once one has been installed."""
    import click

    from ur.get.model import PACKAGE_NAME
    from ur.source.suggest import get_command

    wanted = sorted(name for name in names if PACKAGE_NAME.fullmatch(name))
    if not wanted:
        return False
    command = f"ur get {' '.join(wanted)}" if len(wanted) > 1 else get_command(wanted[0])
    if not _can_ask(options):
        sys.stderr.write(f"help: {command} prints how to get what is missing, and asks before it installs\n")
        return False
    listed = f"{', '.join(wanted)} {'is' if len(wanted) == 1 else 'are'} missing"
    if not click.confirm(f"{listed}; find out where to get that?", default=True, err=True):
        return False
    from ur.cli.files.get import get_packages

    before = _known(wanted)
    get_packages(wanted)
    return _known(wanted) > before


def _known(names: Iterable[str]) -> int:
    from ur.get.missing import is_installed
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import add_own_package

    world = SystemWorld(add_own_package(os.environ))
    return sum(is_installed(name, world) for name in names)


def _can_ask(options: LaunchOptions) -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty() and not (options.json or options.detach or options.part)
