"""`ur use`: which robot is meant."""

from __future__ import annotations

import os
import socket
import sys

import click

from ur.cli.environment import PACKAGE, current_selection
from ur.robot.selection import Selection, parse_selection, selection_path, store_selection
from ur.source.suggest import did_you_mean


@click.command("use")
@click.argument("selection", required=False, metavar="[sim|ROBOT][:BASE[:VARIANT]]")
def command(selection: str | None) -> int:
    """Select a robot, or show which one is selected.

    `ur use sim` selects the simulated robot, `ur use sim:magni` the simulated Magni, `ur use sim:magni:lidar` the one
    with a lidar; `ur use ROBOT` the robot whose computer answers to ROBOT.local. Without an argument it prints the
    selection.
    """
    if selection is None:
        sys.stdout.write(f"{current_selection(os.environ)}\n")
        return 0
    chosen = parse_selection(selection)
    check_base(chosen)
    store_selection(selection_path(os.environ), chosen)
    sys.stdout.write(f"{chosen}\n")
    sys.stdout.flush()
    if not chosen.simulated:
        warn_of_stranger(chosen.robot)
    return 0


def warn_of_stranger(robot: str) -> None:
    """Say so when a robot of this name was never set up from here: it may be one of somebody else, or a slip."""
    from ur.robot.record import load_records, records_folder

    names = [record.name for record in load_records(records_folder(os.environ))]
    if robot.lower() in (*names, socket.gethostname().split(".")[0].lower()):
        return
    near = did_you_mean(robot, names)
    help_ = f"did you mean 'ur use {near}'?" if near else "'ur robots' shows who is there"
    sys.stderr.write(f"note: robot {robot!r} was not set up from this computer\n  help: {help_}\n")


def check_base(chosen: Selection) -> None:
    """Raise UserError when the base or its variant is not one that we have."""
    if chosen.base:
        from ur.robot.base import load_base  # YAML is only needed here
        from ur.robot.base_search import find_base_package

        load_base(find_base_package(PACKAGE, chosen.base, os.environ), chosen.base, chosen.variant)
