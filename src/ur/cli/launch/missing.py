"""Installation of packages that a launch file lacks: xacro at once, others after a question."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterable

from ur.request.options import LaunchOptions


def make_xacro() -> None:
    """Build the ROS package xacro. Raises UserError."""
    from ur.get.offer import install_xacro_package

    sys.stderr.write("installing xacro, once ...\n")
    install_xacro_package(os.environ)


def offer(options: LaunchOptions, names: Iterable[str]) -> bool:
    """Ask whether `ur get` may search for packages, and run it; return True once one has been installed."""
    from ur.get.offer import make_offer

    offered = make_offer(names)
    if offered is None:
        return False
    if not _can_ask(options):
        sys.stderr.write(f"help: {offered.help}\n")
        return False
    import click

    if not click.confirm(offered.question, default=True, err=True):
        return False
    from ur.cli.files.get import get_packages

    before = offered.count_installed(os.environ)
    get_packages(offered.names)
    return offered.count_installed(os.environ) > before


def _can_ask(options: LaunchOptions) -> bool:
    return sys.stdin.isatty() and sys.stderr.isatty() and not (options.json or options.detach or options.part)
