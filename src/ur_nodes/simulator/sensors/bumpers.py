"""Bumpers: which sectors of a robot's outline are pressed by what it touches."""

import math
from collections.abc import Iterable

import numpy as np
import numpy.typing as npt

from ur.robot.base import Bumpers
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.simulator.sensors.sense import Send, Sense, Site, open_switches

Floats = npt.NDArray[np.float64]
Sector = tuple[float, float]
HOLD = 0.15  # s; contacts of rigid bodies flicker


class BumperRing:
    """The bumpers of one robot."""

    def __init__(self, bumpers: Bumpers) -> None:
        self._sectors = {bumper.name: (bumper.start, bumper.end) for bumper in bumpers.at}
        self._pressed = dict.fromkeys(self._sectors, -math.inf)

    def press(self, touches: Iterable[Floats], time: float) -> None:
        """Note what touches the robot at a time (s).

        Each item is one thing: the points at which it touches, shape (points, 2), in m in `base_footprint`. Along the
        whole arc between its points the outline is taken to be pressed.
        """
        arcs = [span_arc(np.arctan2(points[:, 1], points[:, 0])) for points in touches]
        for name, sector in self._sectors.items():
            if any(arcs_meet(sector, arc) for arc in arcs):
                self._pressed[name] = time

    def state(self, time: float) -> dict[str, bool]:
        """Return the states of the bumpers at a time (s): pressed are those that were within the last `HOLD`."""
        return {name: time - pressed <= HOLD for name, pressed in self._pressed.items()}


def span_arc(angles: Floats) -> Sector:
    """The shortest arc (rad, counter-clockwise from, to) that holds all of some angles; at least one is expected."""
    ordered = np.sort(np.mod(angles, 2.0 * math.pi))
    gaps = np.diff(ordered, append=ordered[0] + 2.0 * math.pi)
    widest = int(np.argmax(gaps))
    begin = float(ordered[(widest + 1) % len(ordered)])
    return begin, begin + max(0.0, 2.0 * math.pi - float(gaps[widest]))


def arcs_meet(one: Sector, other: Sector) -> bool:
    """Return True when two arcs (rad, counter-clockwise from, to, at most a turn) share a direction, ends included."""
    turn = 2.0 * math.pi
    return (other[0] - one[0]) % turn <= one[1] - one[0] or (one[0] - other[0]) % turn <= other[1] - other[0]


class BumperSense(Sense):
    """The bumpers of one robot."""

    def __init__(self, bumpers: Bumpers, site: Site) -> None:
        self._bumpers, self._site = bumpers, site
        self.begin()

    def begin(self) -> None:
        """None is pressed."""
        self._ring = BumperRing(self._bumpers)

    def feel_touch(self, time: float) -> None:
        """Note what touches the robot."""
        self._ring.press(self._site.physics.touches(self._site.robot), time)

    def pressed(self, time: float) -> dict[str, bool]:
        """Return the states at a time (s), by name."""
        return self._ring.state(time)

    def advertise(self, node: Node, prefix: str, quality: Quality) -> Send:  # noqa: ARG002 - switches are latched
        """Open a topic for each."""
        topics = {each.name: f"{prefix}{self._bumpers.topic}/{each.name}" for each in self._bumpers.at}
        return open_switches(node, topics, self.pressed)


SENSE = BumperSense
