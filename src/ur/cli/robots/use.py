"""`ur use`: which robot is meant."""

from __future__ import annotations

import os
import socket
import sys

import click

from ur.request.environment import PACKAGE, current_selection
from ur.robot.selection import Selection, parse_selection, selection_path, store_selection
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean


@click.command("use")
@click.argument("selection", required=False, metavar="[sim|ROBOT][:BASE[:VARIANT]]")
@click.option("--away", is_flag=True, help="Select a robot that is away and was never set up from this computer.")
def command(selection: str | None, away: bool) -> int:
    """Select a robot, or show which one is selected.

    `ur use sim` selects the simulated robot, `ur use sim:magni` the simulated Magni, `ur use sim:magni:lidar` the one
    with a lidar; `ur use ROBOT` the robot whose computer answers to ROBOT.local. Without an argument it prints the
    selection.
    """
    if selection is None:
        if away:
            raise UserError(error("--away needs the name of a robot", rule="bad-options", help="ur use --away ROBOT"))
        sys.stdout.write(f"{current_selection(os.environ)}\n")
        return 0
    chosen = parse_selection(selection)
    note = "" if chosen.simulated else check_robot(chosen, away=away)
    check_base(chosen)
    store_selection(selection_path(os.environ), chosen)
    sys.stdout.write(f"{chosen}\n")
    sys.stdout.flush()
    sys.stderr.write(note)
    return 0


def check_robot(chosen: Selection, *, away: bool) -> str:
    """Raise UserError for an unknown robot, unless it may be `away`.

    Return the note about one that is not set up from this computer: it may belong to other people.
    """
    from ur.robot.discovery.known import look_up_robot
    from ur.source.progress_line import show_progress

    with show_progress(f"looking up {chosen.robot}.local"):
        found = look_up_robot(chosen.robot, os.environ, hostname=socket.gethostname())
    if found.evidence in ("set up", "this computer"):
        return ""
    near = did_you_mean(chosen.robot, found.others)
    if found.evidence == "none" and not away:
        raise UserError(
            error(
                f"unknown robot {chosen.robot!r}: it was not set up from this computer, and "
                f"{chosen.robot}.local does not answer",
                rule="unknown-robot",
                help=_advise(chosen, near),
                subject=chosen.robot,
            )
        )
    help_ = f"did you mean 'ur use {near}'?" if near and near != chosen.robot else "'ur robots' lists the robots"
    return f"note: robot {chosen.robot!r} was not set up from this computer\n  help: {help_}\n"


def _advise(chosen: Selection, near: str | None) -> str:
    away = f"to select a robot that is away: ur use --away {chosen}"
    bases = _list_bases()
    if chosen.robot in bases:
        simulated = ":".join(part for part in ("sim", chosen.robot, chosen.base) if part)
        return f"the simulated one is 'ur use {simulated}'; {away}"
    if near:
        return f"did you mean 'ur use {near}'? {away}"
    base = did_you_mean(chosen.robot, bases)
    if base:
        return f"did you mean the simulated robot 'ur use sim:{base}'? {away}"
    return f"'ur robots' lists the robots on the network; {away}"


def _list_bases() -> tuple[str, ...]:
    from ur.robot.base import list_bases
    from ur.robot.base.search import list_base_packages

    return tuple(name for package in list_base_packages(PACKAGE, os.environ) for name in list_bases(package))


def check_base(chosen: Selection) -> None:
    """Raise UserError when the base or its variant is not one that we have."""
    if chosen.base:
        from ur.robot.base import load_base  # YAML is only needed here
        from ur.robot.base.search import find_base_package

        load_base(find_base_package(PACKAGE, chosen.base, os.environ), chosen.base, chosen.variant)
