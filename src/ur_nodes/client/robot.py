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

from ur.source.diagnostic import UserError
from ur_nodes.client.commands import VelocityCommands
from ur_nodes.client.driver_text import describe_driver, describe_silence
from ur_nodes.client.errors import Lost, Refused, TakenOver, check_finite
from ur_nodes.client.exploration import ExplorationStatus
from ur_nodes.client.mux import describe_emergency
from ur_nodes.client.navigation import Names
from ur_nodes.client.navigator import RobotNavigator
from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot, heading_there
from ur_nodes.client.wait import Wait, WatchedWait, wait_in_real_time
from ur_nodes.exploration.status import ExploreStatus, describe_status
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import angles_of_beams, classify_ranges
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Battery, Map, PackedPicture, Scan, Twist
from ur_nodes.run import attach

Value = TypeVar("Value")

Waypoint = tuple[float, float] | tuple[float, float, float]
"""x, y (m) and, where it matters, the heading in degrees, to the left of the x axis."""

_PATIENCE = 10.0  # s
_FOREVER = 1e9  # s
_LONGEST_DRIVE = 60.0  # s
_FRESH = 2.0  # s: how old a sensor's value may be


class Robot:
    """The robot that the environment selects (`ur env`), for `with Robot() as robot:`; a program has one.

    The program takes part in the lease as every other: it drives while no other client does, commands prove their age,
    and mux and navigation keep their limits. The lease goes back when the context is left, also by an exception and
    Ctrl-C: then goals of this program are cancelled, and velocities end. A program that hangs while it drives does so
    no more: its velocity ends within 0.6 s, its goal is held within 4 s.

    All methods wait, and raise Lost, Refused or TakenOver (`ur_nodes.client.errors`). One thread may use them.
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
        self._ended = False
        self._values: dict[str, tuple[object, float]] = {}
        self._goal = 0

    def __enter__(self) -> Robot:
        if self._given is not None:
            self._connect(self._given)
        else:
            try:
                self._closing.enter_context(attach(f"{self._name}_{os.getpid()}", self._connect, self._note_end))
            except UserError as problem:
                raise Lost(str(problem)) from None
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            self.stop()
            if self._given is not None:
                self._on_node(self._navigator.lease.release)
        finally:
            self._closing.close()

    # -- what the robot senses -------------------------------------------------------------------------------------

    def pose(self) -> Pose2:
        """The pose of the robot in the map: m, m, rad. Raises Lost: nothing localises it, or not for 3 s."""
        topics = self._navigator.topics
        known = self._until(lambda: topics.robot.pose() is not None and not topics.robot.silent, _PATIENCE)
        pose = topics.robot.pose()
        if not known or pose is None:
            frames = f"{self._names.map_frame} -> {self._names.base_frame}"
            raise Lost(f"the pose of the robot is not known (tf {frames}); is it localised?")
        return pose

    def scan(self) -> Scan:
        """The newest scan of the lidar, at most 2 s old: ranges in m, angles in rad in its own frame. Raises Lost."""
        return self._newest("scan", Scan, _FRESH)

    def nearest(self, width: float = 360.0) -> float:
        """The distance (m) from the lidar to what is nearest within `width` degrees about ahead of it.

        inf where nothing is in reach. Raises Lost.
        """
        scan = self.scan()
        angles = angles_of_beams(len(scan.ranges), scan.angle_min, scan.angle_increment)
        about = abs((angles + math.pi) % (2.0 * math.pi) - math.pi) <= math.radians(width) / 2.0
        hits = classify_ranges(scan.ranges, (scan.range_min, scan.range_max)).hits & about
        return float(scan.ranges[hits].min()) if hits.any() else math.inf

    def map(self) -> Map:
        """The newest map; its grid has the resolution in m. Raises Lost."""
        return self._newest("map", Map, _FOREVER, Quality.LATCHED)

    def battery(self) -> Battery:
        """The newest state of the battery: V, A, Ah, a fraction of 0 to 1; NaN where not measured. Raises Lost."""
        return self._newest("battery_state", Battery, _FOREVER)

    def picture(self, topic: str = "raspicam_node/image/compressed") -> PackedPicture:
        """A picture of a camera, at most 2 s old, as a JPEG or PNG file. Raises Lost."""
        return self._newest(topic, PackedPicture, _FRESH)

    def events(self) -> tuple[str, ...]:
        """The reasons, as lines for people, for which the robot does not drive for this program now; () when it may."""
        snapshot = self._navigator.snapshot()
        silence = (
            f"nothing from {snapshot.silence.who} for {snapshot.silence.seconds:.0f} s" if snapshot.silence else ""
        )
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
        if not self._until(lambda: not self._navigator.snapshot().missing, _PATIENCE):
            raise Lost(f"still waiting for {'; '.join(self._navigator.snapshot().missing)}")
        self._require_permission()
        yaw = heading_there(self.pose(), x, y) if heading_degrees is None else math.radians(heading_degrees)
        try:
            self._goal = self._navigator.go(Pose2(x, y, yaw), any_heading=heading_degrees is None)
        except UserError as problem:
            raise Lost(str(problem)) from None
        try:
            self._until(lambda: self._settled(self._navigator.snapshot()), _FOREVER)
            snapshot = self._navigator.snapshot()
            self._judge(snapshot, snapshot.goal)
        except BaseException:
            self.stop()
            raise
        self._goal = 0
        return self.pose()

    def follow(self, waypoints: Iterable[Waypoint]) -> list[Pose2]:
        """Drive to one place after the other, and return the poses there. Raises as `go_to`."""
        return [self.go_to(*waypoint) for waypoint in waypoints]

    def drive(self, forward: float, turn: float, seconds: float) -> None:
        """Drive at a velocity (m/s, rad/s to the left) for so long (s, at most 60), then stop.

        The mux keeps the limits of the base on speed and acceleration, and its obstacle stop. Raises Refused,
        TakenOver, and Lost, also when this program hung meanwhile.
        """
        check_finite(forward=forward, turn=turn, seconds=seconds)
        if not 0.0 < seconds <= _LONGEST_DRIVE:
            raise ValueError(f"seconds: {seconds}, expected more than 0, at most {_LONGEST_DRIVE:g}")
        link, commands = self._navigator.lease.link, self._commands
        if not self._until(lambda: link.newest() is not None and commands.listeners() > 0, _PATIENCE):
            raise Lost("nothing from the mux, whose challenges prove the age of commands; is the robot running?")
        self._require_permission()
        try:
            self._on_node(lambda: commands.begin(Twist(forward, turn), seconds))
            self._until(lambda: not commands.on or self._hindrance() is not None, seconds + 1.0)
            if (problem := self._hindrance()) is not None:
                raise problem
            if commands.hung:
                raise Lost("this program hung, and its velocity has ended")
        finally:
            self._on_node(commands.end)

    def stop(self) -> None:
        """Stop what this program has begun: its velocity, and its goal."""
        self._on_node(self._stop)
        if self._goal:
            self._wait(lambda: self._navigator.snapshot().goal.over, 2.0)
            self._goal = 0

    def explore(self) -> ExploreStatus:
        """Wait until the exploration that runs on the robot (`ur run explore`) has ended, and return its status.

        Raises Refused: none runs.
        """
        if not self._until(lambda: self._exploration.shown() is not None, _PATIENCE):
            raise Refused("nothing explores, expected a robot that does ('ur run explore' starts it)")
        self._until(lambda: self._exploration.newest.ended or self._exploration.shown() is None, _FOREVER)
        status = self._exploration.newest
        if status.state != "complete":
            raise Refused(describe_status(status))
        return status

    def _connect(self, node: Node) -> None:
        self._node = node
        self._wait = wait = WatchedWait(node, self._given_wait)
        self._commands = commands = VelocityCommands(node, "key_vel", wait.hangs)
        self._navigator = RobotNavigator(
            node, self._names, self._name, wait, commands.answer, lambda: bool(self._goal) and wait.hangs()
        )
        commands.connect(self._navigator.lease)
        self._exploration = ExplorationStatus(node, "explore/status")

    def _note_end(self) -> None:
        self._ended = True

    def _on_node(self, call: Callable[[], None]) -> None:
        """Make a call on the node's thread, and wait until it is made; after the end of the node it is not."""
        done: list[bool] = []

        def make() -> None:
            try:
                call()
            finally:
                done.append(True)

        self._node.post(make)
        self._wait(lambda: bool(done) or self._ended, 2.0)

    def _until(self, condition: Callable[[], bool], seconds: float) -> bool:
        """Wait; raises Lost when the node has ended."""
        found = self._wait(lambda: self._ended or condition(), seconds)
        if self._ended:
            raise Lost("the connection to the robot has ended")
        return found

    def _newest(self, topic: str, kind: type[Value], fresh: float, quality: Quality = Quality.NEWEST) -> Value:
        """The newest value of a topic, at most `fresh` s old; listens from the first time on."""
        if topic not in self._values:
            self._values[topic] = (None, -math.inf)
            self._on_node(lambda: self._listen(topic, kind, quality))
        if not self._until(lambda: self._node.steady() - self._values[topic][1] <= fresh, _PATIENCE):
            raise Lost(f"no {kind.__name__.lower()} on {self._node.resolve(topic)}; does the robot publish it?")
        return cast("Value", self._values[topic][0])

    def _listen(self, topic: str, kind: type[Value], quality: Quality) -> None:
        def take(value: Value) -> None:
            self._values[topic] = (value, self._node.steady())

        self._node.subscribe(topic, kind, take, quality)

    def _require_permission(self) -> None:
        """Raise what keeps this program from driving; wait while the state of the lease is not settled."""
        self._until(lambda: not self._navigator.snapshot().lease.pending or self._hindrance() is None, _PATIENCE)
        if (problem := self._hindrance(started=False)) is not None:
            raise problem

    def _hindrance(self, *, started: bool = True) -> Lost | Refused | TakenOver | None:
        """The reasons that keep this program from driving. `started`: it drives already."""
        snapshot = self._navigator.snapshot()
        lease = snapshot.lease
        if snapshot.silence is not None:
            return Lost(describe_silence(snapshot.silence.who, snapshot.silence.seconds))
        if snapshot.mux.stopped:
            return Refused("the emergency stop is on, expected it to be released first")
        if lease.other or lease.lost_by_other:
            text = describe_driver(lease, hint="it has to let go first").removesuffix("; d: take over")
            return TakenOver(text) if started else Refused(text)
        return None

    def _settled(self, snapshot: RobotSnapshot) -> bool:
        """Return whether there is nothing more to wait for: the goal is over, or not this program's any more."""
        goal, silence = snapshot.goal, snapshot.silence
        lost = silence is not None and silence.seconds > _PATIENCE
        return lost or goal.number != self._goal or goal.over or goal.state is LastGoalState.HELD

    def _judge(self, snapshot: RobotSnapshot, goal: GoalReport) -> None:
        """Return for a goal that was reached; raise what became of another one."""
        if goal.number == self._goal and goal.state is LastGoalState.REACHED:
            return
        if snapshot.lease.other or goal.number != self._goal:
            self._goal = 0  # what is driven to now is not ours to cancel
            driver = describe_driver(snapshot.lease, hint="this program's goal has ended")
            raise TakenOver(driver or "another client has sent a goal")
        if snapshot.silence is not None and not goal.over and goal.state is not LastGoalState.HELD:
            raise Lost(describe_silence(snapshot.silence.who, snapshot.silence.seconds))
        raise Refused(goal.text or f"the goal was {goal.state.value}")

    def _stop(self) -> None:
        self._commands.end()
        if self._goal and self._navigator.topics.goal().number == self._goal:
            self._navigator.topics.cancel_goals()
