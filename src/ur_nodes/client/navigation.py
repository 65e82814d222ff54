"""The topics of navigation: map, scan, transforms, plans and the goals of all clients, without a lease of its own."""

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ur.source.printable import one_line
from ur_nodes.client.goal_tracker import (
    LONGEST_TEXT,
    GoalTracker,
    is_unconfirmed,
    read_hold,
    report_at,
    track_current,
    track_hold,
    track_result,
    track_sent,
    track_status,
)
from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot, describe_doubt
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import points_of_scan
from ur_nodes.ports.actions import Goal, GoalState
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import ScanFeed
from ur_nodes.ports.values import Map, Path, PoseEstimate, Result, Scan, StampedPose

Wait = Callable[[Callable[[], bool], float], bool]
"""Waits until a condition is true, at most so many seconds, and returns whether it is."""

_POLL = 0.01  # s
_HUNG_AFTER = 0.5  # s


def wait_in_real_time(condition: Callable[[], bool], seconds: float) -> bool:
    """See `Wait`, for a node with a thread of its own."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() >= end:
            return condition()
        time.sleep(_POLL)
    return True


class WatchedWait:
    """A `Wait` of a thread that other threads monitor."""

    def __init__(self, node: Node, wait: Wait) -> None:
        self._node, self._wait = node, wait
        self._seen_at = node.steady()
        self.on_look: Callable[[], None] = lambda: None
        """Called by the thread itself whenever it looks after its condition."""

    def __call__(self, condition: Callable[[], bool], seconds: float) -> bool:
        def look() -> bool:
            self._seen_at = self._node.steady()
            self.on_look()
            return condition()

        return self._wait(look, seconds)

    def hangs(self, after: float = _HUNG_AFTER) -> bool:
        """Return whether the thread has not checked its condition for `after` s. For any thread."""
        return self._node.steady() - self._seen_at > after


def call_and_wait(node: Node, wait: Wait, service: str, request: object, within: float = 5.0) -> Result:
    """Call a service and wait for the answer. Not for the node's thread."""
    answers: list[Result] = []
    node.post(lambda: node.call(service, request, answers.append, within))
    wait(lambda: bool(answers), within + 1.0)
    return answers[0] if answers else Result(False, f"no answer of {node.resolve(service)} within {within:g} s")


SILENT = 3.0
"""Seconds without a transform of the robot after which its pose is out of date."""

BASE_LINK = "base_link"  # REP 105
_SPEED_WINDOW = 0.2  # s
_PATIENCE = 0.3  # s for which a scan waits for odometry, to be shown nevertheless
_STATUS_SILENT = 3.0  # s
# The spread of a pose that a person points at, for the localiser: RViz's "2D Pose Estimate" sends the same.
_POINTED = np.diag((0.25, 0.25, (math.pi / 12) ** 2))


@dataclass(frozen=True, slots=True)
class Names:
    """Frames, the topic of the global path, the node that is the mux; everything else is remapped as usual."""

    map_frame: str = "map"
    base_frame: str = "base_footprint"
    plan_topic: str = "move_base/NavfnROS/plan"
    mux: str = "cmd_vel_mux"


class RobotState:
    """The state of the robot from its transforms and its lidar. Reads may come from any thread."""

    def __init__(self, node: Node, map_frame: str, base_frame: str) -> None:
        self._node, self._map_frame, self._base_frame = node, map_frame, base_frame
        self._tree = node.transforms
        self._stamp: float | None = None
        self._moved_at = -math.inf
        self._scan: tuple[str, NDArray[np.float64]] | None = None
        self._feed = ScanFeed(node, "", base_frame, self._on_scan, reports=False, patience=_PATIENCE)
        self._tree.watch(self._note_transform)

    @property
    def silent(self) -> bool:
        """True when the robot's newest transform was received too long ago."""
        return self.age() > SILENT

    def age(self) -> float:
        """Seconds since the newest transform of the robot was received; infinite before the first."""
        return self._node.steady() - self._moved_at

    def pose(self) -> Pose2 | None:
        """Return the newest pose in the map frame."""
        return self.pose_of(self._base())

    def pose_of(self, frame: str) -> Pose2 | None:
        """Return the newest pose of a frame in the map frame."""
        return self._tree.find_planar(self._map_frame, frame)

    def odometry_pose(self) -> Pose2 | None:
        """Return the newest pose in the topmost frame of the robot: that of its odometry, where there is no map."""
        base = self._base()
        return self._tree.find_planar(self._tree.root(base), base) if self._tree.parent(base) else None

    def velocity(self) -> tuple[float, float, float]:
        """Return the mean velocity over the last moments, ahead and to the left (m/s) and turning (rad/s)."""
        return (0.0, 0.0, 0.0) if self.silent else self._tree.velocity(self._base(), _SPEED_WINDOW)

    def scan(self, *, by_odometry: bool = False) -> NDArray[np.float64] | None:
        """Return the hits (n, 2) of the newest scan in the map frame or that of `odometry_pose`, in m."""
        if self._scan is None:
            return None
        parent, points = self._scan
        frame = self._tree.root(parent) if by_odometry else self._map_frame
        place = self._tree.find_planar(frame, parent)
        return place.transform_points(points) if place else None

    def _base(self) -> str:
        """Return the base frame; `base_link` if the robot publishes no other one."""
        known = self._tree.parent(self._base_frame) or not self._tree.parent(BASE_LINK)
        return self._base_frame if known else BASE_LINK

    def _note_transform(self) -> None:
        base = self._base()
        self._feed.odom_frame, self._feed.base_frame = self._tree.parent(base) or "", base
        stamp = self._tree.newest(base)
        if stamp is not None and stamp != self._stamp:
            self._stamp, self._moved_at = stamp, self._node.steady()

    def _on_scan(self, scan: Scan, odometry: Pose2 | None) -> None:
        # Held in the base's parent, so that a robot that turns does not drag the scan along until the next one.
        if mount := self._feed.find_mount(scan.frame):
            points = points_of_scan(scan, mount)
            points = odometry.transform_points(points) if odometry else points
            self._scan = (self._feed.odom_frame or self._feed.base_frame, points)


class NavigationTopics:
    """The topics and requests of navigation. Reads may come from any thread."""

    def __init__(self, node: Node, names: Names) -> None:
        self._node, self._names = node, names
        self._seen = RobotSnapshot()
        self._tracker = GoalTracker()
        self._sent: Goal | None = None  # that may have to be sent again
        self._doubt = (-1, "")  # number of a goal that was reached, and what is doubtful about its place
        self._status_at = -math.inf
        self._driven_to = False  # a goal that is not the followed one is open
        self._kept = True  # the next goal of navigation may be one that it had before and has kept
        self.robot = RobotState(node, names.map_frame, names.base_frame)
        self._goals = node.follow_goals("move_base", self)
        self._poses = node.publish("initialpose", PoseEstimate)
        node.subscribe("map", Map, self._on_map, Quality.LATCHED)
        node.subscribe("amcl_pose", PoseEstimate, self._on_estimate, Quality.LATCHED)
        node.subscribe(names.plan_topic, Path, self._on_plan)
        node.subscribe("move_base/current_goal", StampedPose, self._on_current_goal, Quality.LATCHED)
        node.subscribe("amcl/lost", str, self._on_lost, Quality.LATCHED)
        node.subscribe("move_base/hold", str, self._on_hold, Quality.LATCHED)

    def snapshot(self) -> RobotSnapshot:
        """Return the newest state, without mux, lease and silence."""
        seen, goal, pose = self._seen, self.goal(), self.robot.pose()
        speed, _, turn = self.robot.velocity()
        # What a goal needs and is missing
        names = self._names
        missing = []
        if self._seen.grid is None:
            missing.append(f"the map (topic {self._node.resolve('map')})")
        if pose is None:
            missing.append(f"the robot's pose (tf {names.map_frame} -> {names.base_frame})")
        elif self.robot.silent:
            missing.append(f"an update of the robot's pose (tf {names.map_frame} -> {names.base_frame} is silent)")
        if not self._goals.servers() or self.status_age() > _STATUS_SILENT:
            missing.append(f"navigation (action {self._node.resolve('move_base')})")
        return replace(
            seen,
            pose=pose,
            scan=self.robot.scan(),
            goal=goal,
            path=None if goal.over else seen.path,
            speed=speed,
            turn=turn,
            missing=tuple(missing),
        )

    def goal(self) -> GoalReport:
        """Return the last goal."""
        report = report_at(self._tracker, self._node.steady())
        if report.state is not LastGoalState.REACHED:
            return report
        if self._doubt[0] != report.number:  # later poses are not about this goal
            self._doubt = report.number, describe_doubt(self._seen.spread)
        return replace(report, text=self._doubt[1])

    def status_age(self) -> float:
        """Seconds since navigation's last list of goals; infinite before the first."""
        return self._node.steady() - self._status_at

    def send_goal(self, goal_id: str, pose: Pose2, number: int = 0) -> int:
        """Send a goal with this id. Returns its number in `GoalReport`: the one given, or (0) the next."""
        self._tracker = track_sent(self._tracker, goal_id, pose, self._node.steady(), number)
        self._seen = replace(self._seen, path=None)
        self._sent = Goal(goal_id, StampedPose(self._node.now(), self._names.map_frame, pose))
        self._goals.send(self._sent)
        return self._tracker.report.number

    def cancel_goals(self) -> None:
        """Cancel the goal of any client."""
        self._sent = None
        self._goals.cancel()

    def set_pose(self, pose: Pose2) -> None:
        """Set the estimated pose of the robot."""
        self._poses.send(PoseEstimate(self._node.now(), self._names.map_frame, pose, _POINTED))

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        self._status_at = self._node.steady()
        self._tracker = track_status(self._tracker, states, self._status_at)
        if self._sent is not None and is_unconfirmed(self._tracker, self._status_at):
            self._goals.send(self._sent)
        self._driven_to = any(each.open and each.id != self._tracker.goal_id for each in states)

    def on_goal_end(self, state: GoalState) -> None:
        self._tracker = track_result(self._tracker, state, self._node.steady())

    def _on_map(self, value: Map) -> None:
        self._seen = replace(self._seen, grid=value.grid)

    def _on_estimate(self, estimate: PoseEstimate) -> None:
        variance = float(estimate.covariance[0, 0] + estimate.covariance[1, 1])
        self._seen = replace(self._seen, spread=math.sqrt(max(0.0, variance)))

    def _on_lost(self, text: str) -> None:
        self._seen = replace(self._seen, lost=one_line(text[:LONGEST_TEXT]))

    def _on_plan(self, path: Path) -> None:
        self._seen = replace(self._seen, path=path.poses[:, :2])
        if self._driven_to and self._tracker.report.over and len(path.poses):
            # Nav2 does not publish the goals of other clients: the path to one ends there.
            self._tracker = track_current(self._tracker, Pose2(*path.poses[-1]), self._node.steady())

    def _on_current_goal(self, goal: StampedPose) -> None:
        kept, self._kept = self._kept, False
        if kept and self._tracker.goal_id and not self._tracker.report.over:
            return  # it may be older than the goal that was sent meanwhile, whose state tells if another replaces it
        self._tracker = track_current(self._tracker, goal.pose, self._node.steady())

    def _on_hold(self, text: str) -> None:
        hold = read_hold(text)
        if hold is not None:
            self._tracker = track_hold(self._tracker, hold)
