"""Installation of packages that a launch file lacks: xacro at once, the others after a question."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable
from pathlib import Path

from ur.request.options import LaunchOptions


def make_xacro() -> None:
    """Make the ROS package xacro, recorded for `ur get --undo`. Raises UserError."""
    from ur.get.install import install
    from ur.get.record import record_path
    from ur.get.steps import GetPlan, InstallStep, Missing
    from ur.request.environment import own_packages

    sys.stderr.write("installing xacro, once ...\n")
    plan = GetPlan((InstallStep(Missing("xacro"), "pypi", ("xacro",)),))
    install(plan, record_path(os.environ), Path(own_packages(os.environ)))


def offer(options: LaunchOptions, names: Iterable[str]) -> bool:
    """Ask whether `ur get` should look for packages, and run it; True once one has been installed."""
    import click

    from ur.get.steps import PACKAGE_NAME
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
