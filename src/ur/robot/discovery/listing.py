"""List of robots: visible ones with their announcements, known ones that are away, and name conflicts. Pure."""

import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

from ur.robot.discovery.announcements import Announcement
from ur.robot.discovery.record import RobotRecord
from ur.robot.discovery.seen import SeenRobot, describe_age


@dataclass(frozen=True, slots=True)
class RobotAnswer:
    """The answers of a robot; None for those that are missing.

    `nodes`: number of nodes that its ROS master knows; `services`: its boot services with systemd's ActiveState;
    `offset` (s): how far its clock is ahead; `twin`: the address of another computer with the same name, '' if there is
    none. `answers` is False if it answered no query at all: announcements are cached for an hour or more. `refused` is
    the reason why it did not answer over ssh, '' if it did; `known_as` is the name of its host key on this computer.
    """

    nodes: int | None = None
    services: tuple[tuple[str, str], ...] | None = None
    offset: float | None = None
    twin: str = ""
    answers: bool | None = None
    refused: str = ""
    known_as: str = ""


@dataclass(frozen=True, slots=True)
class RobotRow:
    """A row of the list of robots. `address` is empty if the robot is away; `problem` is empty if there is none."""

    name: str
    address: str
    base: str = ""
    variant: str = ""
    version: str = ""
    answer: RobotAnswer = RobotAnswer()
    seen: SeenRobot | None = None
    problem: str = ""
    help: str = ""
    ros: str = ""

    @property
    def ros_name(self) -> str:
        """Return the version of ROS, if known: a robot that announces a base and no release of ROS 2 has ROS 1."""
        return f"2 {self.ros.capitalize()}" if self.ros else "1" if self.base else ""

    @property
    def runs(self) -> str:
        """Describe the running ROS nodes and boot services in a few words."""
        nodes = self.answer.nodes
        if nodes is None:
            words = ["no ROS master"] if self.answer.services is not None and not self.ros else []
        else:
            words = ["no nodes yet" if nodes == 0 else "1 node" if nodes == 1 else f"{nodes} nodes"]
        words += [name if state == "active" else f"{name} ({state})" for name, state in self.answer.services or ()]
        return ", ".join(words)

    @property
    def clock(self) -> str:
        """Describe the offset of the robot's clock from the local one, or the reason why it is unknown."""
        if self.answer.offset is None:
            return f"unknown: {self.answer.refused}" if self.answer.refused else ""
        return f"{self.answer.offset:+.3f} s"

    def when(self, now: float) -> str:
        """Describe since when the robot is away and its last address; 'here' if it is not away."""
        if self.address:
            return "here"
        return f"away, {describe_age(now - self.seen.time)} at {self.seen.address}" if self.seen else "away"


def is_settled(answer: RobotAnswer) -> bool:
    """Return whether no more answers are expected of a robot: it is away, has refused, or has answered completely.

    A master without nodes is not settled: after a boot or a rename, the first node starts later than the master.
    """
    if answer.answers is False or answer.refused:
        return True
    if answer.services is None or answer.offset is None:
        return False
    return "master" not in dict(answer.services) or bool(answer.nodes)


def list_robots(
    sightings: Iterable[Announcement],
    records: Sequence[RobotRecord],
    answers: Mapping[str, RobotAnswer] | None = None,
    memory: Mapping[str, SeenRobot] | None = None,
) -> list[RobotRow]:
    """List the visible robots, then known ones that are away; each group by name.

    `answers` are by the host name of a sighting, `memory` by the name of a robot.
    """
    reported = answers or {}
    announced = sorted(sightings, key=lambda one: (one.name, one.host))
    there = [one for one in announced if reported.get(one.host, RobotAnswer()).answers is not False]
    names = [one.name for one in there]
    recorded = {record.name for record in records}
    rows = [
        _row(one, names.count(one.name) > 1, reported.get(one.host, RobotAnswer()), is_recorded=one.name in recorded)
        for one in there
    ]
    known = {
        **{one.name: RobotRecord(one.name, one.user, one.base, one.variant, ros=one.ros) for one in announced},
        **{record.name: record for record in records},
    }
    taken = {address for one in there for address in one.addresses}
    # A robot last seen at the address of a visible one, and never set up from here, is that one by its former name.
    remembered = {name for name, seen in (memory or {}).items() if seen.address not in taken}
    for name in sorted({*known, *remembered} - {*names}):
        record = known.get(name, RobotRecord(name, "", ""))
        rows.append(RobotRow(name, "", record.base, record.variant, seen=(memory or {}).get(name), ros=record.ros))
    return rows


def choose_rows(rows: Sequence[RobotRow], names: Collection[str]) -> list[RobotRow]:
    """Return the rows of these robots, with an empty row for an unknown robot; all rows if no names are given."""
    if not names:
        return [*rows]
    chosen = [row for row in rows if row.name in names]
    missing = sorted(set(names) - {row.name for row in chosen})
    return [*chosen, *(RobotRow(name, "") for name in missing)]


def _row(one: Announcement, twice: bool, answer: RobotAnswer, *, is_recorded: bool) -> RobotRow:
    problem = help = ""
    name = one.name
    where = one.address or ", ".join(one.addresses)
    if not twice and one.host != one.name and not re.fullmatch(rf"{re.escape(one.name)}-\d+", one.host):
        name = one.host
        if is_recorded and answer.known_as not in (one.name, one.host):
            # Any computer may announce the name of a known robot: an unknown one is not proposed for a set-up.
            problem = f"{name} announces the name of {one.name}, and has not shown the host key of {one.name}"
            help = "is it yours? compare, at its own screen: ssh-keygen -lf /etc/ssh/ssh_host_ed25519_key.pub"
        else:
            problem = f"{name} announces its former name, {one.name}"
            help = f"ur robot setup {name}.local --name {name}"
    elif twice or one.host != one.name:
        problem = f"two computers are called {one.name}: this one ({where}) answers to {one.host}.local"
        # The computer with the original name keeps it.
        help = f"ur robot setup {one.host}.local --name ANOTHER" if one.host != one.name else "rename the other one"
    elif answer.twin and answer.twin not in one.addresses:
        problem = f"two computers are called {one.name}: the other one ({answer.twin}) answers to {one.name}-2.local"
        help = f"ur robot setup {one.name}-2.local --name ANOTHER"
    elif answer.known_as not in ("", one.name):
        problem = f"{one.name} was renamed: this computer knows it as {answer.known_as}"
        help = f"ur robot rename {answer.known_as} {one.name}"
    return RobotRow(name, where, one.base, one.variant, one.version, answer, problem=problem, help=help, ros=one.ros)
