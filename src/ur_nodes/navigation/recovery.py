"""What to try when the robot is stuck, in which order, and when to give up."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from ur_nodes.navigation.costmap import Costmap
from ur_nodes.navigation.footprint import Footprint
from ur_nodes.navigation.local_plan import Motion, sweep_is_free
from ur_nodes.navigation.speed_profile import Limits, approach
from ur_nodes.rosio.pose import Pose2, wrap_angle


class Behaviour(Enum):
    """One thing to try."""

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
    """How far a recovery has come.

    How many behaviours were `tried`, the pose where the present one `began` (or the last one ended), what it has
    `done` so far (rad turned, m backed).
    """

    tried: int = 0
    began: Pose2 | None = None
    done: float = 0.0
    last: Pose2 | None = None

    @property
    def behaviour(self) -> Behaviour | None:
        """What is being tried, None when nothing is left."""
        return SEQUENCE[self.tried] if self.tried < len(SEQUENCE) else None

    def forgotten(self, pose: Pose2, distance: float) -> Recovery:
        """Back to the first behaviour when the robot has come `distance` m away from where it was stuck."""
        if self.began is None or self.tried == 0:
            return self
        far = (pose.x - self.began.x) ** 2 + (pose.y - self.began.y) ** 2 > distance**2
        return Recovery() if far else self


@dataclass(frozen=True, slots=True)
class RecoveryMotion:
    """The next command of a behaviour that moves: m/s, rad/s; `finished` when it is over (also: when it must stop)."""

    recovery: Recovery
    speed: float
    turn: float
    finished: bool


def move_to_recover(
    recovery: Recovery,
    motion: Motion,
    costmap: Costmap,
    footprint: Footprint,
    limits: Limits,
    period: float,
    distance: float = 0.3,
) -> RecoveryMotion:
    """One control step of ROTATE (once round) or BACK_OFF (`distance` m).

    Ends early, at rest, where it would touch something within half a second.
    """
    began = recovery.began or motion.pose
    last = recovery.last or motion.pose
    if recovery.behaviour is Behaviour.ROTATE:
        done = recovery.done + abs(wrap_angle(motion.pose.yaw - last.yaw))
        speed, turn, over = 0.0, 0.6 * limits.turn, done >= 6.28
    else:
        done = ((motion.pose.x - began.x) ** 2 + (motion.pose.y - began.y) ** 2) ** 0.5
        speed, turn, over = -limits.backward, 0.0, done >= distance
    state = replace(recovery, began=began, done=done, last=motion.pose)
    trial = Motion(motion.pose, speed, turn)
    if over or not sweep_is_free(trial, 0.5, costmap, footprint):
        return RecoveryMotion(state, 0.0, 0.0, finished=True)
    return RecoveryMotion(
        state,
        approach(motion.speed, speed, limits.acceleration * period),
        approach(motion.turn, turn, limits.turn_acceleration * period),
        finished=False,
    )
