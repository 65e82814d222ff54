"""`ur run FILE.py`: a user's script, in the environment of the selected robot."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from ur.request.environment import apply_selection, current_selection
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError, error
from ur.source.project import launch_library


def is_script(program: str) -> bool:
    """Return whether a program's name is that of a Python file."""
    return program.endswith(".py") and Path(program).is_file()


def run_script(
    path: str,
    arguments: Sequence[str],
    *,
    apply: Callable[[Selection], None] = apply_selection,
    execute: Callable[[str, list[str]], object] = os.execv,
) -> int:
    """Run a script in place of this process, for the selected robot. Raises UserError."""
    selection = current_selection(os.environ)
    if not selection.simulated:
        from ur.cli.robots.over_ssh import is_over_ssh

        if is_over_ssh(selection):
            there = f"copy {path} to the robot and type there: ur run {Path(path).name}"
            message = f"{selection.robot} runs ROS 2 and is reached by ssh, expected a script on the robot itself"
            raise UserError(error(message, rule="not-here", help=there))
    apply(selection)
    if os.environ.get("ROS_VERSION") == "0":
        message = "no ROS on this computer, expected ROS 1 or ROS 2 between a script and the robot"
        raise UserError(
            error(message, rule="no-ros", help="install it: ur setup; 'ur use --ros 2' needs no Debian package")
        )
    sys.stdout.flush()
    node = str(launch_library() / "lib" / "node")
    execute(node, [node, str(Path(path).absolute()), *arguments])
    return 0
