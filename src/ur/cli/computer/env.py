"""`ur env`: what makes a shell follow the selection."""

from __future__ import annotations

import os

import click

from ur.cli.output import write_exactly
from ur.request.environment import current_selection, environment_changes, render_exports


@click.command("env")
def command() -> int:
    """Print the lines that let a shell follow the selection.

    Evaluate it, once or in ~/.bashrc: eval "$(ur env)". Then roslaunch, rosrun and every other ROS tool find the
    packages and the master of the selected robot. Evaluating it again does no harm.
    """
    changes = environment_changes(current_selection(os.environ), os.environ)
    write_exactly(render_exports(changes))
    return 0
