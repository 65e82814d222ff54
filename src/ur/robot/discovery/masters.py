"""ROS masters of the robots that this computer knows: those that were set up from here, seen here, or are simulated."""

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass

from ur.robot.discovery.record import load_records, records_folder
from ur.robot.discovery.seen import load_seen, seen_path
from ur.robot.selection import SIMULATION, Selection, parse_selection
from ur.source.diagnostic import UserError

MOST = 50
"""Robots in the list: the file of those that were seen holds what the network has announced."""


@dataclass(frozen=True, slots=True)
class RobotMaster:
    """A robot's name, its argument for `ur use` and `ur web`, and the URI of its ROS master."""

    name: str
    selection: str
    master: str

    @property
    def simulated(self) -> bool:
        """Return whether this is the simulated robot."""
        return self.name == SIMULATION


def list_masters(environment: Mapping[str, str], own: Selection, stored: Selection) -> tuple[RobotMaster, ...]:
    """List the simulated robot, and the others by name, at most MOST. Sends nothing to the network.

    `own` is the robot that is shown, which is always listed; `stored` is the selected robot, whose base is kept.
    """
    records = [each.name for each in load_records(records_folder(environment))]
    return choose_masters(records, load_seen(seen_path(environment)), own, stored)


def choose_masters(
    records: Iterable[str], seen: Iterable[str], own: Selection, stored: Selection
) -> tuple[RobotMaster, ...]:
    """List the masters for these names, without invalid host names and names equal to that of the simulated robot."""
    chosen: dict[str, Selection] = {each.robot.lower(): each for each in (stored, own)}
    kept = {own.robot.lower(): own, SIMULATION: chosen.get(SIMULATION, Selection())}
    for name in (*sorted(records), *sorted(seen)):
        with suppress(UserError):
            found = parse_selection(name)
            if found.robot == name and len(kept) < MOST:
                kept.setdefault(name.lower(), chosen.get(name.lower(), found))
    ordered = sorted(kept.values(), key=lambda each: (not each.simulated, each.robot.lower()))
    return tuple(RobotMaster(each.robot, str(each), each.master_uri) for each in ordered)
