"""The pursuit of one goal: the navigator's state between two control steps."""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass, field

from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.leg_follower import LegFollower
from ur_nodes.navigation.navigator_step import NavigatorPhase
from ur_nodes.navigation.planning.path_geometry import Points
from ur_nodes.navigation.steering.recovery import Recovery

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
    asked: float | None = None
    last_asked: float = -math.inf
    stuck_since: float | None = None
    waited_since: float | None = None
    trouble_since: float | None = None
    moved_at: float = 0.0
    moved_from: Pose2 | None = None
    recovery: Recovery = field(default_factory=Recovery)
    reason: str = ""
    sent: tuple[float, float] = (0.0, 0.0)


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
