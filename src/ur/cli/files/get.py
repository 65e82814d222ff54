"""`ur get`: install what launch files need."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.source.diagnostic import user_error
from ur.source.progress_line import show_progress

if TYPE_CHECKING:
    from ur.get.steps import GetPlan, Needs

_ROUNDS = 5  # rounds: installed packages may name further ones


@dataclass(slots=True)
class _Choices:
    """The choices of the user, from options or answers; the question is asked once."""

    missing: bool = False
    yes: bool = False
    dry_run: bool = False
    others: bool | None = None

    def may_install(self, names: Sequence[str]) -> bool:
        """Return whether these packages, which do not belong to ROS, may be installed."""
        if self.others is None:
            self.others = self._confirm(f"also install {', '.join(names)}, which are not packages of ROS?")
        return self.others

    def _confirm(self, question: str) -> bool:
        # `--yes` does not answer this question: it is for packages that ROS needs.
        asks = sys.stdin.isatty() and not self.yes and not self.dry_run
        return asks and click.confirm(question, default=False, err=True)


@click.command("get")
@click.argument("words", nargs=-1, metavar="[FILE | PACKAGE | FOLDER]... [NAME:=VALUE]...")
@click.option("--missing", is_flag=True, help="All that the launch files below FOLDER need. [default: ~/catkin_ws/src]")
@click.option("--robot", metavar="ROBOT", help="Install on this robot; names are looked up there.")
@click.option("--yes", is_flag=True, help="Do not ask before packages of ROS are installed.")
@click.option("--others", is_flag=True, help="Also install Debian packages that are not of ROS.")
@click.option("--dry-run", is_flag=True, help="Print the plan, and install nothing.")
@click.option("--index", multiple=True, metavar="FILE", help="A distribution.yaml of ROS, in place of fetching it.")
def command(
    words: tuple[str, ...],
    missing: bool,
    robot: str | None,
    yes: bool,
    dry_run: bool,
    index: tuple[str, ...],
    others: bool,
) -> int:
    """Install what launch files need.

    Prints the plan first: packages of Debian or Ubuntu, packages of PyPI, and for the others the location of their
    source and the commands that build it. Then it asks. The exit code is 1 if something is still missing.
    """
    if not missing and not words:
        raise user_error("nothing to get, expected a launch file or a package", rule="usage", help="ur get --missing")
    if robot is not None:
        flags = [("--missing", missing), ("--yes", yes), ("--dry-run", dry_run), ("--others", others)]
        return _run_on_robot(robot, words, flags)
    choices = _Choices(missing=missing, yes=yes, dry_run=dry_run, others=others or None)
    return _get(words, index, choices)


def get_packages(names: Sequence[str]) -> int:
    """Install packages as `ur get NAME...` does, and return the exit code. Raises UserError."""
    return _get(names, (), _Choices())


def _get(words: Sequence[str], index: Sequence[str], choices: _Choices) -> int:
    from ur.get.install import install
    from ur.get.plan import render_plan
    from ur.request.environment import own_packages

    tried: set[str] = set()
    for _ in range(_ROUNDS):
        from ur.get.computer import ThisComputer, load_tables
        from ur.get.plan import make_plan

        with show_progress("reading what is needed") as progress:
            needs = _find_needs(words, missing=choices.missing, progress=progress)
            progress("looking for packages")
            computer = ThisComputer(os.environ, index)
            tables, found = load_tables(needs.missing, computer, _distribution(), needs.names)
        notes = (*needs.notes, *found) if needs.missing else needs.notes
        plan = make_plan(needs.missing, tables, needs.is_there, notes)
        if not plan.steps:
            scope = " of what was read" if plan.notes else ""
            click.echo("".join(f"note: {note}\n" for note in plan.notes) + f"nothing is missing{scope}")
            return 0
        click.echo(render_plan(plan), nl=False)
        if choices.dry_run:
            return 1
        plan = _take_others(plan, choices)
        new = {step.missing.package for step in (*plan.steps_by("debian"), *plan.steps_by("pypi"))} - tried
        if not new:
            return 1
        if not all(step.chosen for step in (*plan.steps_by("debian"), *plan.steps_by("pypi"))):
            _ask("install these packages?", yes=choices.yes)
        install(plan, Path(own_packages(os.environ)))
        tried |= new
    return 1


def _take_others(plan: GetPlan, choices: _Choices) -> GetPlan:
    """Return the plan with its other Debian packages among those to install, if the user agrees."""
    others = plan.steps_by("other")
    if not others or not choices.may_install([name for step in others for name in step.names]):
        return plan
    steps = (replace(step, method="debian", chosen=True) if step.method == "other" else step for step in plan.steps)
    return replace(plan, steps=tuple(steps))


def _find_needs(words: Sequence[str], *, missing: bool, progress: object) -> Needs:
    from ur.get.folder import find_needs, folder_needs
    from ur.request.environment import add_own_package

    environment = add_own_package(os.environ)
    if not missing:
        return find_needs(words, environment)
    workspace = Path("~/catkin_ws/src").expanduser()
    return folder_needs(words or [str(workspace) if workspace.is_dir() else "."], environment, progress)  # type: ignore[arg-type]


def _distribution() -> str:
    name = os.environ.get("ROS_DISTRO", "")
    return name if name.isalnum() and Path("/opt/ros", name).is_dir() else ""


def _ask(question: str, *, yes: bool) -> None:
    if yes:
        return
    if not sys.stdin.isatty():
        message = "there is no terminal to ask on, expected --yes or --dry-run"
        raise user_error(message, rule="no-terminal", help="--yes agrees to the plan above")
    if not click.confirm(question, default=True):
        raise user_error("cancelled; nothing was changed", rule="refused")


def _run_on_robot(robot: str, words: Sequence[str], flags: Sequence[tuple[str, bool]]) -> int:
    from ur.cli.robots.shell import run_ssh
    from ur.request.remote.connection import robot_address
    from ur.robot.boot.units import LIBRARIES
    from ur.robot.ssh.failures import lost_connection
    from ur.robot.ssh.shell import quote

    arguments = quote("get", *(flag for flag, given in flags if given), "--", *words)
    script = "".join(
        f'[ ! -r "$HOME/{place}/.venv/ready-run" ] || exec "$HOME/{place}/.venv/bin/python" -I -m ur {arguments}; '
        for place in LIBRARIES
    )
    script += "echo 'error: ubiquity_launches is not set up on the robot; ur robot setup installs it' >&2; exit 2"
    address, terminal = robot_address(robot), ["-t"] if sys.stdin.isatty() else []
    done = run_ssh(address, terminal, [quote("bash", "-lc", script)], escaped=True)
    if done == 255:
        raise lost_connection(str(address), "")
    return done
