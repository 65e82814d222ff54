"""The pursuit of one goal: the navigator's state between two control steps."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.leg_follower import Driving, LegFollower, legs_back
from ur_nodes.navigation.navigator_step import NavigatorInputs, NavigatorPhase, NavigatorSettings
from ur_nodes.navigation.people.tracked_people import room_to_people
from ur_nodes.navigation.planning.path_geometry import Points
from ur_nodes.navigation.steering.recovery import Recovery
from ur_nodes.navigation.steering.speed_profile import AT_REST, DriveVelocity, SpeedLimits

_TRACK_STEP, _TRACK_TURN = 0.05, 0.1  # m, rad between poses of the track that is kept
_TRACK = 120  # such poses
_FORGOTTEN = 15.0  # s after the last waiting, when another begins
_WAITED = 0.3  # m from where the robot waited for people, after which it does not any more
_CORNERED, _PATIENCE = 0.7, 6.0  # m to people, and s of waiting for them, after which they seem unable to leave
_RETREAT = 0.6  # m back to make room for them, and between two places where the robot does


@dataclass(slots=True)
class GoalPursuit:
    """The state of a navigator that pursues a goal. Times are in s; places in the map or the odometry frame."""

    goal: Pose2
    phase: NavigatorPhase
    phase_since: float
    any_heading: bool = False
    path: Points | None = None
    legs: LegFollower | None = None
    last_turn: float | None = None
    retreat: LegFollower | None = None
    shunts: int = 0
    asked: float | None = None
    last_asked: float = -math.inf
    stuck_since: float | None = None
    waited_since: float | None = None
    waited_at: Pose2 | None = None
    waited_last: float = 0.0
    made_room_at: Pose2 | None = None
    trouble_since: float | None = None
    moved_at: float = 0.0
    moved_from: Pose2 | None = None
    contacts: int = 0
    backing: Recovery = field(default_factory=Recovery)
    recovery: Recovery = field(default_factory=Recovery)
    reason: str = ""
    sent: DriveVelocity = AT_REST

    def is_stuck(self, blocked: bool, now: float, pose: Pose2, settings: NavigatorSettings) -> bool:
        """No command for the controller's patience but such that move little, or commanded to move and not moving."""
        if blocked and self.stuck_since is None:
            self.stuck_since = now
        elif not blocked and self.stuck_since is not None and self.moved_at > self.stuck_since:
            self.stuck_since = None
        began = self.moved_from
        if began is None or math.dist(pose[:2], began[:2]) > 0.05 or abs(wrap_angle(pose.yaw - began.yaw)) > 0.2:
            self.moved_from, self.moved_at = pose, now
        if self.stuck_since is not None and now - self.stuck_since > settings.controller_patience:
            return True
        return now - self.moved_at > settings.progress_timeout

    def may_ask(self, now: float, least: float) -> bool:
        """Return whether to request a plan: none is in progress (or for too long), and the last is `least` s old."""
        waiting = self.asked is not None and now - self.asked < 10.0
        return not waiting and now - self.last_asked >= least

    def is_at_end(self, pose: Pose2, odom: Pose2, tolerance: float) -> bool:
        """Return whether a pose in the odometry frame is well within a distance (m) of the end of the path."""
        if self.path is None:
            return False
        return math.dist(odom.transform_points(self.path[-1]), pose[:2]) < 0.9 * tolerance

    def enter(self, phase: NavigatorPhase, now: float) -> None:
        """Begin a phase."""
        self.phase, self.phase_since, self.stuck_since = phase, now, None
        self.moved_from, self.moved_at = None, now

    def end_recovery(self, pose: Pose2, now: float) -> None:
        """Plan anew after a recovery behaviour."""
        self.recovery = Recovery(self.recovery.tried + 1, began=pose)
        self.waited_since = None
        self.enter(NavigatorPhase.PLANNING, now)

    def wait(self, now: float, pose: Pose2) -> float:
        """Wait for people, which is no lack of progress. Return how long so far, s."""
        if not self.waited(now):
            self.waited_since, self.waited_at = now, pose
        self.moved_at = self.waited_last = now
        self.stuck_since = None
        return self.waited(now)

    def waited(self, now: float) -> float:
        """Return how long the robot has waited for people, s; waiting of long ago does not count."""
        return 0.0 if self.waited_since is None or now - self.waited_last > _FORGOTTEN else now - self.waited_since

    def drive_on(self, pose: Pose2) -> None:
        """End the waiting for people where the robot has left the place; a few centimetres do not end it."""
        if self.waited_at is None or math.dist(self.waited_at[:2], pose[:2]) > _WAITED:
            self.waited_since = None

    def begin_to_make_room(self, inputs: NavigatorInputs, waited: float, driving: Driving, track: DrivenTrack) -> bool:
        """Choose a way back, once in a place, where people near the robot have not left while it `waited` (s)."""
        assert inputs.motion is not None
        assert inputs.local is not None
        pose, before = inputs.motion.pose, self.made_room_at
        made = before is not None and math.dist(before[:2], pose[:2]) < _RETREAT
        if made or waited < _PATIENCE or room_to_people(pose, inputs.local.people, driving.footprint) > _CORNERED:
            return False
        self.made_room_at, self.retreat = pose, track.way_back(_RETREAT, driving.limits)
        return self.retreat is not None


class DrivenTrack:
    """The `poses` that the robot has passed, in the odometry frame, oldest first."""

    def __init__(self) -> None:
        self.poses: deque[Pose2] = deque(maxlen=_TRACK)

    def remember(self, pose: Pose2) -> None:
        """Add a pose that is away from the last one."""
        last = self.poses[-1] if self.poses else None
        if (
            last is None
            or math.hypot(pose.x - last.x, pose.y - last.y) > _TRACK_STEP
            or abs(wrap_angle(pose.yaw - last.yaw)) > _TRACK_TURN
        ):
            self.poses.append(pose)

    def way_back(self, distance: float, limits: SpeedLimits) -> LegFollower | None:
        """Return the way back along the track for at most `distance` m, None without a track."""
        legs = legs_back(self.poses, distance, sideways=limits.lateral > 0.0)
        return LegFollower(legs) if legs else None


def blocked_at(pose: Pose2, odom: Pose2) -> str:
    """Return the reason of a robot that an obstacle blocks at a pose in the odometry frame."""
    place = odom.inverse().compose(pose)
    return f"an obstacle blocks the way near ({place.x:.2f}, {place.y:.2f})"
