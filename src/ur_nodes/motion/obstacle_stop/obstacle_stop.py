"""The obstacle stop from topics: readings of the base's sensors in, guards of the mux and reports out."""

from collections.abc import Callable
from functools import partial

import numpy as np

from ur.robot.base import Base
from ur.source.printable import printable
from ur_nodes.geometry.hull import Floats, Hull, hull_of_outline
from ur_nodes.motion.mux_time import mux_clock
from ur_nodes.motion.obstacle_stop.guard import Guard, GuardVerdict, make_guard, reach_of
from ur_nodes.motion.obstacle_stop.report import CLEAR, OFF, Motion, ObstacleReport, report_of, write_report
from ur_nodes.motion.obstacle_stop.sensors import sensors_of
from ur_nodes.motion.obstacle_stop.sight import Contact, Odometer, SensorRanges, Sight, look, move, touch
from ur_nodes.motion.writes import AsideLog, Writes
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import feed_beams
from ur_nodes.ports.services import Switch
from ur_nodes.ports.values import Odometry, Range, Result, Scan

_LONGEST = 80  # characters
_SPREAD = 0.5  # rad to either side of the direction of a cliff sensor


def make_sight(base: Base, *, sonars: bool = True) -> Sight:
    """Return the sight of a base before any reading; `sonars`: it has those of its file."""
    hull = hull_of_outline(base.footprint)
    return Sight(hull, sensors_of(base, hull, sonars=sonars), reach_of(hull, base.limits))


def contact_points(base: Base, hull: Hull, contact: tuple[Contact, str]) -> Floats:
    """The points of the outline (n, 2) in the base's frame that a bumper or a cliff sensor of the base covers."""
    kind, name = contact
    if kind == "cliff":
        directions = {} if base.cliffs is None else {cliff.name: cliff.direction for cliff in base.cliffs.at}
        return hull.edge_points(directions[name] - _SPREAD, directions[name] + _SPREAD)
    at = {} if base.bumpers is None else {bumper.name: bumper for bumper in base.bumpers.at}
    return hull.edge_points(at[name].start, at[name].end)


def contact_topics(base: Base) -> dict[tuple[Contact, str], str]:
    """The topic of each bumper and of each cliff sensor of the base."""
    topics: dict[tuple[Contact, str], str] = {}
    if base.bumpers:
        topics |= {("bumper", each.name): f"{base.bumpers.topic}/{each.name}" for each in base.bumpers.at}
    if base.cliffs:
        topics |= {("cliff", each.name): f"{base.cliffs.topic}/{each.name}" for each in base.cliffs.at}
    return topics


def explain_frame(base: Base, frame: str) -> str:
    """Return the warning about ranges in a frame of no sonar of the base; empty if the frame is one of them."""
    known = [sonar.frame for sonar in base.sonars.at] if base.sonars else []
    if frame in known:
        return ""
    expected = f"expected a sonar of the base file: {', '.join(known)}"
    return f"the obstacle stop ignores ranges of '{printable(frame)[:_LONGEST]}', {expected}"


_CHOSEN = "obstacle_stop_chosen"  # on the parameter server, so that the choice outlives this process
_EVERY = 0.2  # s between two reports of the same state
_LOG_EVERY = 5.0  # s


class ObstacleStop:
    """Owns the sight of a base; calls `watch` with each new guard, None while it is off.

    Nothing is subscribed for a base without sensors that it can use.
    """

    def __init__(
        self,
        node: Node,
        base: Base,
        watch: Callable[[Guard | None], object],
        writes: Writes,
        *,
        on: bool,
        sonars: bool,
        lag: float,
    ) -> None:
        """`on` is the initial choice, `sonars`: the base has those of its file, `lag` (s) that of the mux."""
        self._node, self._base, self._watch, self._writes = node, base, watch, writes
        self._log, self._time = AsideLog(node), mux_clock(node)
        sight = make_sight(base, sonars=sonars)
        self._sensors = {sensor.name: sensor for sensor in sight.sensors}
        self._guard = make_guard(sight, base.limits, lag)
        usable = bool(sight.sensors or base.bumpers or base.cliffs)
        self._on = usable and node.parameters.any(_CHOSEN, on) is True
        self._warned = False
        self._reported_at = self._logged_at = float("-inf")
        self._publisher = node.publish("~obstacle_stop", str, Quality.LATCHED)
        self._publish(CLEAR if self._on else OFF if usable else ObstacleReport())
        if not usable:
            return
        self._watch(self._guard if self._on else None)
        node.subscribe("odom", Odometry, self._on_odometry)
        if base.lidar:
            feed_beams(node, base.lidar.topic, partial(self._on_scan, base.lidar.topic))
        if base.sonars and sonars:
            node.subscribe(base.sonars.topic, Range, self._on_range, Quality.EVERY)  # all of a base come together
        for contact, topic in contact_topics(base).items():
            for quality in (Quality.LATCHED, Quality.NEWEST):  # a third-party driver may not latch its contacts
                node.subscribe(topic, bool, partial(self._on_contact, contact), quality)
        node.serve_later("~set_obstacle_stop", Switch, self._choose)

    def note(self, verdict: GuardVerdict | None, wanted: Motion, output: Motion) -> None:
        """Publish the report of a verdict of the mux, for a wanted velocity and what was sent."""
        if not self._on:
            return
        report = report_of(verdict, wanted, output)
        if report == self._reported:
            return
        now = self._time()
        if report.state == self._reported.state and now - self._reported_at < _EVERY:
            return
        self._reported_at = now
        if report.state == "stopped" != self._reported.state and not 0.0 <= now - self._logged_at < _LOG_EVERY:
            self._logged_at = now
            self._log.info(report.text)
        self._publish(report)

    def _publish(self, report: ObstacleReport) -> None:
        self._reported = report
        self._publisher.send(write_report(report))

    def _choose(self, request: Switch, give: Callable[[Result], None]) -> None:
        self._on = request.on
        self._watch(self._guard if self._on else None)
        self._publish(CLEAR if self._on else OFF)
        word = "on" if self._on else "off"
        self._log.info(f"the obstacle stop is {word}")
        keep = partial(self._node.parameters.keep, _CHOSEN, self._on)
        self._writes.write(_CHOSEN, keep, lambda _problem: give(Result(True, word)))

    def _change(self, sight: Sight) -> None:
        guard = self._guard
        if sight is guard.sight:
            return
        self._guard = Guard(sight, guard.braking, guard.lag)
        if self._on:
            self._watch(self._guard)

    def _time_of(self, stamp: int) -> float:
        """The mux's time at which a value was measured, by its stamp (ns); not later than now."""
        now = self._time()
        return now - max(0.0, (self._node.now() - stamp) * 1e-9) if stamp else now

    def _on_odometry(self, odometry: Odometry) -> None:
        twist = odometry.twist
        reading = Odometer(odometry.pose, twist.forward, twist.turn, self._time_of(odometry.stamp), twist.left)
        self._change(move(self._guard.sight, reading))

    def _on_scan(self, topic: str, scan: Scan, turn: float) -> None:
        sensor = self._sensors.get(topic)
        if sensor is None:
            return
        at, angles = self._time_of(scan.stamp), (scan.angle_min, scan.angle_increment)
        reading = SensorRanges(scan.ranges, (scan.range_min, scan.range_max), at, *angles, turn)
        self._change(look(self._guard.sight, sensor, reading))

    def _on_range(self, value: Range) -> None:
        sensor = self._sensors.get(value.frame)
        if sensor is None:
            if not self._warned and (reason := explain_frame(self._base, value.frame)):
                self._warned = True
                self._log.warn(reason)
            return
        limits = value.range_min, value.range_max
        reading = SensorRanges(np.array([value.range]), limits, self._time_of(value.stamp), cone=value.field_of_view)
        self._change(look(self._guard.sight, sensor, reading))

    def _on_contact(self, contact: tuple[Contact, str], touched: bool) -> None:
        points = contact_points(self._base, self._guard.sight.hull, contact) if touched else None
        self._change(touch(self._guard.sight, contact, points))
