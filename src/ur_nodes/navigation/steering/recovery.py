"""Recovery behaviours of a robot that is stuck, their order, and when to give up."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np
from scipy.ndimage import distance_transform_edt

from ur_nodes.costmap.costmap import LETHAL
from ur_nodes.costmap.footprint import Footprint
from ur_nodes.geometry.pose import Pose2, arc_end, wrap_angle
from ur_nodes.navigation.people.tracked_people import hull_of_footprint, rooms_to
from ur_nodes.navigation.steering.local_obstacles import LocalObstacles
from ur_nodes.navigation.steering.local_plan import sweep_is_free
from ur_nodes.navigation.steering.rollout import RolloutState
from ur_nodes.navigation.steering.speed_profile import AT_REST, DriveVelocity, SpeedLimits, change_velocity

_BACK_OFF, _FARTHEST = 0.3, 0.9  # m: to back off, and as long as there is no room to turn
_LOOKS = (4.0, 1.0)  # s that are looked ahead for a way to back off, the shorter one where nothing else is free
_BENDS = (0.0, 0.25, 0.5, 1.0, 2.0, 5.0)  # 1/m: gentle ones lead away from a wall beside the robot
_ROOMY = 0.3  # m: more room is no better


class Behaviour(Enum):
    """A recovery behaviour."""

    CLEAR_FAR = "forget the obstacles farther away"
    ROTATE = "look round by turning once"
    BACK_OFF = "back off a little"
    CLEAR_ALL = "forget all obstacles"


SEQUENCE = (Behaviour.CLEAR_FAR, Behaviour.ROTATE, Behaviour.BACK_OFF, Behaviour.CLEAR_ALL, Behaviour.ROTATE)


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


def begin_recovery(
    recovery: Recovery, motion: RolloutState, around: LocalObstacles, footprint: Footprint, limits: SpeedLimits
) -> Recovery:
    """Return the begin of the next behaviour: a robot without room to turn backs off first."""
    first = SEQUENCE.index(Behaviour.BACK_OFF)
    skips = recovery.tried < first and not _can_turn(motion.pose, around, footprint, limits)
    return Recovery(first if skips else recovery.tried)


@dataclass(frozen=True, slots=True)
class RecoveryMotion:
    """The next command of a moving behaviour; `finished` when it ends or must stop."""

    recovery: Recovery
    command: DriveVelocity
    finished: bool


def move_to_recover(
    recovery: Recovery,
    motion: RolloutState,
    around: LocalObstacles,
    footprint: Footprint,
    limits: SpeedLimits,
    period: float,
) -> RecoveryMotion:
    """One control step of ROTATE (once round) or BACK_OFF (0.3 m, or until it can turn on the spot).

    Ends early, at rest, where it would touch something within half a second.
    """
    began = recovery.began or motion.pose
    last = recovery.last or motion.pose
    if recovery.behaviour is Behaviour.ROTATE:
        done = recovery.done + abs(wrap_angle(motion.pose.yaw - last.yaw))
        wanted, over = DriveVelocity(0.0, 0.6 * limits.turn), done >= 6.28 or bool(limits.radius)
    else:
        done = math.hypot(motion.pose.x - began.x, motion.pose.y - began.y)
        wanted = find_escape(motion, around, footprint, limits)
        over = done >= _FARTHEST or (done >= _BACK_OFF and _can_turn(motion.pose, around, footprint, limits))
    state = replace(recovery, began=began, done=done, last=motion.pose)
    trial = RolloutState(motion.pose, *wanted)
    if over or not sweep_is_free(trial, 0.5, around, footprint):
        return RecoveryMotion(state, AT_REST, finished=True)
    return RecoveryMotion(state, change_velocity(motion.velocity, wanted, limits, period), finished=False)


def find_escape(
    motion: RolloutState, around: LocalObstacles, footprint: Footprint, limits: SpeedLimits
) -> DriveVelocity:
    """Find the slow motion towards the most clearance without further contact; backwards rather than ahead."""
    exact = around.exact()
    costmap, hull = exact.costmap, hull_of_footprint(footprint)
    distances = distance_transform_edt(costmap.costs != LETHAL) * costmap.resolution
    bends = sorted({side * bend for bend in _BENDS for side in (1, -1)})
    options = {
        DriveVelocity(speed, limits.turn_at(speed, max(-0.5 * limits.turn, min(0.5 * limits.turn, speed * bend))))
        for speed in (-limits.backward, limits.backward)
        for bend in bends
    }
    if limits.lateral:
        options |= {DriveVelocity(0.0, 0.0, side * min(limits.lateral, limits.backward)) for side in (1, -1)}

    def value(option: DriveVelocity, seconds: float) -> float:
        speed, turn, left = option
        pose = motion.pose.compose(arc_end(speed * seconds, turn * seconds, left * seconds))
        cells = costmap.cells_of_points(pose.transform_points(footprint.samples))
        rooms = distances[tuple(cells[costmap.contains(cells)].T)]
        room = min(_ROOMY, float(rooms.min(initial=1.0)))
        if len(exact.points):
            room = min(room, float(rooms_to(hull, np.array(pose), exact.points).min()))
        return room + (0.02 if speed < 0.0 else 0.0) - 0.005 * abs(turn)

    for seconds in _LOOKS:
        for option in sorted(options, key=lambda option: value(option, seconds), reverse=True):
            if sweep_is_free(RolloutState(motion.pose, *option), seconds, exact, footprint):
                return option
    return DriveVelocity(-limits.backward, 0.0)


def _can_turn(pose: Pose2, around: LocalObstacles, footprint: Footprint, limits: SpeedLimits) -> bool:
    """Return whether the robot may turn to any heading on the spot; True for one that never can."""
    trial = RolloutState(pose, 0.0, limits.turn)
    return bool(limits.radius) or sweep_is_free(trial, math.tau / limits.turn, around, footprint)
