"""A robot for programs of users. Poses are in the frame of the map: m, m, rad (REP 103, 105)."""

from __future__ import annotations

import math
import os
import re
import sys
from collections.abc import Callable, Iterable
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import TypeVar, cast

import numpy as np

from ur.source.diagnostic import UserError
from ur_nodes.client.driver_text import describe_driver, describe_silence
from ur_nodes.client.exploration import ExplorationStatus
from ur_nodes.client.mux import describe_emergency
from ur_nodes.client.navigation import Names, Wait, WatchedWait, wait_in_real_time
from ur_nodes.client.navigator import RobotNavigator
from ur_nodes.client.script.node_calls import Lost, NodeCalls, Refused, TakenOver, check_finite
from ur_nodes.client.snapshot import LastGoalState, RobotSnapshot, heading_there
from ur_nodes.exploration.status import ExploreStatus, describe_status
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import angles_of_beams, classify_ranges
from ur_nodes.motion.challenge.freshness import REQUEST_FRESHNESS
from ur_nodes.motion.challenge.link import FreshPublisher
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.ports.node import Node, Timer
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Map, PackedPicture, Scan, Twist
from ur_nodes.run import attach

STILL = Twist(0.0, 0.0)


class VelocityCommands:
    """Answers challenges of the mux with the requested velocity. Works on the node's thread, except `renew`.

    The thread that asked for the velocity answers each challenge itself, by `renew`: the age of a command is also that
    of the thread's last sign of life, so a program that hangs drives no longer than one that is killed. A velocity
    whose thread `hangs` ends.
    """

    def __init__(self, node: Node, topic: str, hangs: Callable[[], bool]) -> None:
        """`topic` is the one of plain velocities; the stamped ones are beside it."""
        self._node, self._topic, self._hangs = node, topic, hangs
        self.hung = False
        """True when the newest velocity has ended early, because the thread hung."""
        self._twist: Twist | None = None
        self._end: Timer | None = None
        self._answered: int | None = None

    def connect(self, lease: LeaseClient) -> None:
        """Send as a client of this lease."""
        self._lease = lease
        self._publisher = FreshPublisher(self._topic, lease.link, lease.client)

    def subscribers(self) -> int:
        """Return the number of subscribers of the velocities."""
        return self._publisher.subscribers()

    @property
    def on(self) -> bool:
        """Return whether a velocity is being sent."""
        return self._twist is not None

    def begin(self, twist: Twist, seconds: float) -> None:
        """Drive at a velocity for `seconds`; it replaces the last one."""
        self.end(stop=False)
        if not self._lease.view().mine:
            self._lease.acquire()
        self._twist, self.hung = twist, False
        self._end = self._node.after(seconds, self.end, steady=True)
        self._answer()

    def end(self, *, stop: bool = True) -> None:
        """End the velocity; with `stop` send zero at once if this client drives."""
        if self._end is not None:
            self._end.cancel()
        if stop and self._twist is not None and self._lease.view().mine:
            self._publisher.send(STILL)
        self._twist = self._end = None

    def renew(self) -> None:
        """Answer the newest challenge. Called repeatedly by the thread that requested the velocity."""
        newest = self._lease.link.newest()
        if self._twist is not None and newest is not None and newest != self._answered:
            self._answered = newest
            self._node.post(self._answer)

    def check(self) -> None:
        """End the velocity of a thread that hangs; called when a challenge has arrived."""
        if self._twist is not None and self._hangs():
            self.hung = True
            self.end()

    def _answer(self) -> None:
        if self._twist is not None and not self._lease.view().other:
            self._publisher.send(self._twist)


Value = TypeVar("Value")

PATIENCE = 10.0
"""Seconds for which a call waits for what a robot has to send."""

FRESH = 2.0
"""Seconds: the greatest age of a sensor's value."""

FOREVER = 1e9  # s


class SensorValues:
    """Subscribes to topics on first use, and keeps the newest value of each."""

    def __init__(self, calls: NodeCalls) -> None:
        self._calls, self._node = calls, calls.node
        self._values: dict[str, tuple[object, float]] = {}

    def newest(self, topic: str, kind: type[Value], fresh: float, quality: Quality = Quality.NEWEST) -> Value:
        """Return the newest value of a topic, at most `fresh` s old; the first call subscribes. Raises Lost."""
        if topic not in self._values:
            self._values[topic] = (None, -math.inf)
            self._calls.on_node(lambda: self._subscribe(topic, kind, quality))
        if not self._calls.until(lambda: self._node.steady() - self._values[topic][1] <= fresh, PATIENCE):
            raise Lost(f"no {kind.__name__.lower()} on {self._node.resolve(topic)}; does the robot publish it?")
        return cast("Value", self._values[topic][0])

    def _subscribe(self, topic: str, kind: type[Value], quality: Quality) -> None:
        def on_value(value: Value) -> None:
            self._values[topic] = (value, self._node.steady())

        self._node.subscribe(topic, kind, on_value, quality)


def find_hindrance(snapshot: RobotSnapshot, *, started: bool = True) -> Lost | Refused | TakenOver | None:
    """Return the reason that keeps a program from driving. `started`: it drives already."""
    lease = snapshot.lease
    if snapshot.silence is not None:
        return Lost(describe_silence(snapshot.silence.who, snapshot.silence.seconds))
    if snapshot.mux.stopped:
        return Refused("the emergency stop is on, expected it to be released first")
    if lease.other or lease.lost_by_other:
        text = describe_driver(lease, hint="it has to let go first").removesuffix("; d: take over")
        return TakenOver(text) if started else Refused(text)
    return None


def is_settled(snapshot: RobotSnapshot, goal: int, patience: float) -> bool:
    """Return whether to stop waiting: the goal of this number is over, held, or replaced.

    A robot that is silent for longer than `patience` (s) is not waited for either.
    """
    report, silence = snapshot.goal, snapshot.silence
    lost = silence is not None and silence.seconds > patience
    return lost or report.number != goal or report.over or report.state is LastGoalState.HELD


def judge_goal(snapshot: RobotSnapshot, goal: int) -> Lost | Refused | TakenOver | None:
    """Return None if the goal of this number was reached, else the error that describes its end."""
    report = snapshot.goal
    if report.number == goal and report.state is LastGoalState.REACHED:
        return None
    if snapshot.lease.other or report.number != goal:
        driver = describe_driver(snapshot.lease, hint="this program's goal has ended")
        return TakenOver(driver or "another client has sent a goal")
    if snapshot.silence is not None and not report.over and report.state is not LastGoalState.HELD:
        return Lost(describe_silence(snapshot.silence.who, snapshot.silence.seconds))
    return Refused(report.text or f"the goal was {report.state.value}")


Waypoint = tuple[float, float] | tuple[float, float, float]
"""x, y (m) and, where it matters, the heading in degrees, to the left of the x axis."""

CAMERA = "raspicam_node/image/compressed"

_LONGEST_DRIVE = 60.0  # s
_FRESH = REQUEST_FRESHNESS / 2.0  # s: the age of the mux's newest challenge that a goal may answer
_HESITATION = 0.1  # s: a thread that is silent for longer renews no lease while it drives


class Robot:
    """The robot that the environment selects (`ur env`), for `with Robot() as robot:`; a program has one.

    The program uses the lease as every other client: it drives while no other client does, commands prove their age,
    and mux and navigation keep their limits. The lease is released when the context is left, also by an exception and
    Ctrl-C: then goals of this program are cancelled, and velocities end. While the program hangs it drives nothing: a
    velocity ends within 0.3 s, and its goal is held within 3 s, as that of a program that is killed.

    All methods wait, and raise Lost, Refused or TakenOver. One thread may use them, except for `interrupt`.
    """

    def __init__(
        self, name: str = "", *, node: Node | None = None, wait: Wait = wait_in_real_time, names: Names | None = None
    ) -> None:
        """`name` is the program's, for the screens of others; without one it is that of its file.

        For tests: `node` is a node of a bus, `wait` the bus's `run_until`.
        """
        self._name = name or re.sub(r"\W", "_", Path(sys.argv[0]).stem, flags=re.ASCII) or "script"
        self._names, self._given, self._given_wait = names or Names(), node, wait
        self._closing = ExitStack()
        self._goal = 0

    def __enter__(self) -> Robot:
        if self._given is not None:
            self._connect(self._given)
        else:
            try:
                node_name = f"{self._name}_{os.getpid()}"
                self._closing.enter_context(attach(node_name, self._connect, lambda: self._calls.note_end()))
            except UserError as problem:
                raise Lost(str(problem)) from None
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.stop()
            note = f"{self._name} ended with {kind.__name__}" if kind is not None else ""
            self._calls.on_node(lambda: self._navigator.lease.release(note=note))
        finally:
            self._closing.close()

    # -- what the robot senses -------------------------------------------------------------------------------------

    def pose(self) -> Pose2:
        """Return the pose of the robot in the map: `x` and `y` in m, `yaw` in rad, to the left of the x axis.

        Raises Lost: nothing localises it, or not for 3 s.
        """
        topics = self._navigator.topics
        known = self._calls.until(lambda: topics.robot.pose() is not None and not topics.robot.silent, PATIENCE)
        pose = topics.robot.pose()
        if not known or pose is None:
            frames = f"{self._names.map_frame} -> {self._names.base_frame}"
            raise Lost(f"the pose of the robot is not known (tf {frames}); is it localised?")
        return pose

    def scan(self) -> Scan:
        """Return the lidar's newest scan, at most 2 s old: ranges in m, angles in rad in its frame. Raises Lost."""
        return self._senses.newest("scan", Scan, FRESH)

    def nearest(self, width: float = 360.0, direction: float = 0.0) -> float:
        """Return the distance (m) from the lidar to the nearest obstacle within `width` degrees about a direction.

        `direction` is in degrees to the left of ahead. inf if nothing is in range. Raises Lost.
        """
        check_finite(width=width, direction=direction)
        # The shortest range (m) within `width` degrees about `direction` (degrees to the left); inf for none
        scan = self.scan()
        angles = angles_of_beams(len(scan.ranges), scan.angle_min, scan.angle_increment) - math.radians(direction)
        about = np.abs((angles + math.pi) % (2.0 * math.pi) - math.pi) <= math.radians(width) / 2.0
        hits = classify_ranges(scan.ranges, (scan.range_min, scan.range_max)).hits & about
        return float(scan.ranges[hits].min()) if hits.any() else math.inf

    def map(self) -> Map:
        """Return the newest map; its grid has the resolution in m, and 0 to 100 for free to occupied. Raises Lost."""
        return self._senses.newest("map", Map, FOREVER, Quality.LATCHED)

    def battery(self) -> Battery:
        """Return the newest state of the battery: V, A, Ah, a fraction of 0 to 1; NaN if not measured. Raises Lost."""
        return self._senses.newest("battery_state", Battery, FOREVER)

    def picture(self, topic: str = CAMERA) -> PackedPicture:
        """Return a picture of a camera, at most 2 s old; `data` is a JPEG or PNG file. Raises Lost."""
        return self._senses.newest(topic, PackedPicture, FRESH)

    def events(self) -> tuple[str, ...]:
        """Return the reasons that keep the robot from driving for this program now, as lines for users; () if none."""
        # The reasons that keep this program from driving now, as lines for users
        snapshot = self._navigator.snapshot()
        silence = describe_silence(snapshot.silence.who, snapshot.silence.seconds) if snapshot.silence else ""
        emergency = describe_emergency(snapshot.mux, "it is to be released first")
        driver = describe_driver(snapshot.lease, snapshot.conduct, hint="it has to let go first")
        return tuple(each for each in (silence, emergency, driver) if each)

    # -- driving ---------------------------------------------------------------------------------------------------

    def go_to(self, x: float, y: float, heading_degrees: float | None = None) -> Pose2:
        """Drive to a place of the map (m), around obstacles, and return the pose there.

        `heading_degrees` is to the left of the x axis; None: any. Raises Refused: there is no way, or the robot may
        not drive; TakenOver: another client drives, or has sent a goal; Lost: the robot is silent for 10 s.
        """
        check_finite(x=x, y=y, heading_degrees=heading_degrees or 0.0)
        if not self._calls.until(lambda: not self._navigator.snapshot().missing, PATIENCE):
            raise Lost(f"still waiting for {'; '.join(self._navigator.snapshot().missing)}")
        self._require_permission()
        yaw = heading_there(self.pose(), x, y) if heading_degrees is None else math.radians(heading_degrees)
        link, snapshot = self._navigator.lease.link, self._navigator.snapshot
        self._calls.until(lambda: snapshot().lease.state == "unknown" or link.newest(_FRESH) is not None, PATIENCE)
        try:
            self._goal = self._navigator.go(Pose2(x, y, yaw), any_heading=heading_degrees is None)
        except UserError as problem:
            raise Lost(str(problem)) from None
        try:
            self._calls.until(lambda: is_settled(self._navigator.snapshot(), self._goal, PATIENCE), FOREVER)
            end = judge_goal(self._navigator.snapshot(), self._goal)
            if end is not None and self._navigator.topics.goal().number != self._goal:
                self._goal = 0  # what is driven to now is not ours to cancel
            if end is not None:
                raise end
        except BaseException:
            self.stop()
            raise
        self._goal = 0
        return self.pose()

    def follow(self, waypoints: Iterable[Waypoint]) -> list[Pose2]:
        """Drive to one place after the other, and return the poses there. Raises as `go_to`."""
        return [self.go_to(*waypoint) for waypoint in waypoints]

    def drive(self, forward: float, turn: float, seconds: float) -> None:
        """Drive at a velocity (m/s, rad/s to the left) for `seconds` (at most 60), then stop.

        The mux keeps the limits of the base on speed and acceleration, and its obstacle stop. Raises Refused,
        TakenOver, and Lost, also when this program hung meanwhile.
        """
        check_finite(forward=forward, turn=turn, seconds=seconds)
        if not 0.0 < seconds <= _LONGEST_DRIVE:
            raise ValueError(f"seconds: {seconds}, expected more than 0, at most {_LONGEST_DRIVE:g}")
        link, commands, until = self._navigator.lease.link, self._commands, self._calls.until
        snapshot = self._navigator.snapshot

        def is_connected() -> bool:
            known = snapshot().lease.state != "unknown"  # else it could still be that of a program that was lost
            return known and link.newest() is not None and commands.subscribers() > 0

        if not until(is_connected, PATIENCE):
            raise Lost("nothing from the mux, whose challenges prove the age of commands; is the robot running?")
        self._require_permission()
        try:
            self._calls.on_node(lambda: commands.begin(Twist(forward, turn), seconds))
            until(lambda: not commands.on or find_hindrance(self._navigator.snapshot()) is not None, seconds + 1.0)
            if (problem := find_hindrance(self._navigator.snapshot())) is not None:
                raise problem
            if commands.hung:
                raise Lost("this program hung, and its velocity has ended")
        finally:
            self._calls.on_node(commands.end)

    def stop(self) -> None:
        """Stop the velocity and cancel the goal of this program."""
        self._calls.on_node(self._stop)
        if self._goal:
            self._calls.settle(lambda: self._navigator.snapshot().goal.over, 2.0)
            self._goal = 0

    def explore(self) -> ExploreStatus:
        """Wait until the exploration that runs on the robot (`ur run explore`) has ended, and return its status.

        Raises Refused: none runs.
        """
        if not self._calls.until(lambda: self._exploration.shown() is not None, PATIENCE):
            raise Refused("nothing explores, expected a robot that does ('ur run explore' starts it)")
        self._calls.until(lambda: self._exploration.newest.ended or self._exploration.shown() is None, FOREVER)
        status = self._exploration.newest
        if status.state != "complete":
            raise Refused(describe_status(status))
        return status

    def interrupt(self) -> None:
        """Let the waiting call, or the next one that waits, stop its motion and raise Interrupted.

        May be called from any thread.
        """
        self._calls.interrupt()

    def _connect(self, node: Node) -> None:
        wait = WatchedWait(node, self._given_wait)
        self._calls = NodeCalls(node, wait)
        self._senses = SensorValues(self._calls)
        self._commands = commands = VelocityCommands(node, "key_vel", wait.hangs)

        def hangs() -> bool:
            return (bool(self._goal) or commands.on or commands.hung) and wait.hangs(_HESITATION)

        self._navigator = RobotNavigator(node, self._names, self._name, wait, commands.check, hangs)
        commands.connect(self._navigator.lease)
        wait.on_look = commands.renew
        self._exploration = ExplorationStatus(node, "explore/status")

    def _require_permission(self) -> None:
        """Wait until the lease is settled, and raise the reason if this program may not drive."""
        snapshot = self._navigator.snapshot
        self._calls.until(lambda: not snapshot().lease.pending or find_hindrance(snapshot()) is None, PATIENCE)
        if (problem := find_hindrance(snapshot(), started=False)) is not None:
            raise problem

    def _stop(self) -> None:
        self._commands.end()
        if self._goal and self._navigator.topics.goal().number == self._goal:
            self._navigator.topics.cancel_goals()
