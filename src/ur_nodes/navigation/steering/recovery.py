"""Recovery behaviours of a robot that is stuck, their order, and when to give up."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

from scipy.ndimage import distance_transform_edt

from ur_nodes.costmap.costmap import LETHAL
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.local_plan import sweep_is_free
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import SpeedLimits, approach

_BACK_OFF = 0.3  # m


class Behaviour(Enum):
    """A recovery behaviour."""

    CLEAR_FAR = "forget the obstacles farther away"
    ROTATE = "look round by turning once"
    BACK_OFF = "back off a little"
    CLEAR_ALL = "forget all obstacles"


SEQUENCE = (
    Behaviour.CLEAR_FAR,
    Behaviour.ROTATE,
    Behaviour.BACK_OFF,
    Behaviour.CLEAR_ALL,
    Behaviour.ROTATE,
)


@dataclass(frozen=True, slots=True)
class Recovery:
    """The progress of a recovery.

    How many behaviours were `tried`, the pose where the present one `began` (or the last one ended), what it has
    `done` so far (rad turned, m backed).
    """

    tried: int = 0
    began: Pose2 | None = None
    done: float = 0.0
    last: Pose2 | None = None

    @property
    def behaviour(self) -> Behaviour | None:
        """The present behaviour, None when none is left."""
        return SEQUENCE[self.tried] if self.tried < len(SEQUENCE) else None

    def forgotten(self, pose: Pose2, distance: float) -> Recovery:
        """Return the first behaviour's state if the robot is `distance` m away from where it was stuck."""
        if self.began is None or self.tried == 0:
            return self
        far = (pose.x - self.began.x) ** 2 + (pose.y - self.began.y) ** 2 > distance**2
        return Recovery() if far else self


@dataclass(frozen=True, slots=True)
class RecoveryMotion:
    """The next command of a moving behaviour: m/s, rad/s; `finished` when it ends or must stop."""

    recovery: Recovery
    speed: float
    turn: float
    finished: bool


def move_to_recover(
    recovery: Recovery,
    motion: RolloutState,
    around: LocalObstacles,
    footprint: Footprint,
    limits: SpeedLimits,
    period: float,
) -> RecoveryMotion:
    """One control step of ROTATE (once round) or BACK_OFF (0.3 m).

    Ends early, at rest, where it would touch something within half a second.
    """
    began = recovery.began or motion.pose
    last = recovery.last or motion.pose
    if recovery.behaviour is Behaviour.ROTATE:
        done = recovery.done + abs(wrap_angle(motion.pose.yaw - last.yaw))
        speed, turn, over = 0.0, 0.6 * limits.turn, done >= 6.28 or bool(limits.radius)
    else:
        done = math.hypot(motion.pose.x - began.x, motion.pose.y - began.y)
        speed, turn = find_escape(motion, around, footprint, limits)
        over = done >= _BACK_OFF
    state = replace(recovery, began=began, done=done, last=motion.pose)
    trial = RolloutState(motion.pose, speed, turn)
    if over or not sweep_is_free(trial, 0.5, around, footprint):
        return RecoveryMotion(state, 0.0, 0.0, finished=True)
    return RecoveryMotion(
        state,
        approach(motion.speed, speed, limits.acceleration * period),
        approach(motion.turn, turn, limits.turn_acceleration * period),
        finished=False,
    )


def find_escape(
    motion: RolloutState, around: LocalObstacles, footprint: Footprint, limits: SpeedLimits
) -> tuple[float, float]:
    """Find the slow speed and turn towards the most clearance without further contact; backwards rather than ahead."""
    costmap = around.costmap
    distances = distance_transform_edt(costmap.costs != LETHAL) * costmap.resolution
    best, chosen = -math.inf, (-limits.backward, 0.0)
    for speed in (-limits.backward, limits.backward):
        for turn in (0.0, *(limits.turn_at(speed, side * 0.5 * limits.turn) for side in (1, -1))):
            trial = RolloutState(motion.pose, speed, turn)
            if not sweep_is_free(trial, 1.0, around, footprint):
                continue
            yaw = motion.pose.yaw + turn
            middle = motion.pose.yaw + turn / 2
            x, y = motion.pose.x + speed * math.cos(middle), motion.pose.y + speed * math.sin(middle)
            cells = costmap.cells_of_points(Pose2(x, y, yaw).transform_points(footprint.samples))
            rooms = distances[tuple(cells[costmap.contains(cells)].T)]
            room = min(0.3, float(rooms.min(initial=1.0))) + (0.02 if speed < 0.0 else 0.0) - 0.005 * abs(turn)
            if room > best:
                best, chosen = room, (speed, turn)
    return chosen
