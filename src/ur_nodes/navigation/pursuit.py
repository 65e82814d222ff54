"""The pursuit of one goal: the navigator's state between two control steps."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.leg_follower import LegFollower
from ur_nodes.navigation.navigator_step import NavigatorPhase, NavigatorSettings
from ur_nodes.navigation.planning.path_geometry import Points
from ur_nodes.navigation.steering.recovery import Recovery
from ur_nodes.navigation.steering.speed_profile import AT_REST, DriveVelocity

_TRACK_STEP, _TRACK_TURN = 0.05, 0.1  # m, rad between poses of the track that is kept
_TRACK = 120  # such poses


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
    trouble_since: float | None = None
    moved_at: float = 0.0
    moved_from: Pose2 | None = None
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
        if (
            began is None
            or math.hypot(pose.x - began.x, pose.y - began.y) > 0.05
            or (abs(wrap_angle(pose.yaw - began.yaw)) > 0.2)
        ):
            self.moved_from, self.moved_at = pose, now
        if self.stuck_since is not None and now - self.stuck_since > settings.controller_patience:
            return True
        return now - self.moved_at > settings.progress_timeout

    def may_ask(self, now: float, least: float) -> bool:
        """Return whether to request a plan: none is in progress (or for too long), and the last is `least` s old."""
        waiting = self.asked is not None and now - self.asked < 10.0
        return not waiting and now - self.last_asked >= least


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
