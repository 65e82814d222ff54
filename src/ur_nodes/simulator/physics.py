"""Access to MuJoCo: state of bodies and wheels, stepping, placing, contacts."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from ur_nodes.geometry.pose import Pose2, Quaternion, quaternion_of_yaw, yaw_of_quaternion

_STATE = mujoco.mjtState.mjSTATE_INTEGRATION
_SLEEP = mujoco.mjtSleepPolicy
_TINY = 5e-324  # m/s


@dataclass(frozen=True, slots=True)
class BodyMotion:
    """The motion of a body at an instant.

    `attitude` is the quaternion x, y, z, w, body to world; `velocity` that of the body's origin in the world, m/s;
    `turning` the angular velocity in the body, rad/s.
    """

    attitude: Quaternion
    velocity: tuple[float, float, float]
    turning: tuple[float, float, float]


class Physics:
    """A model of `ur_nodes.simulator.mujoco_model` with `robots` robots, and its state. Poses are x, y, yaw: m, rad."""

    def __init__(self, text: str, robots: int, *, sideways: bool = False) -> None:
        """`sideways`: the robots have the joint and the actuators of a base that drives sideways."""
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        self._robots = robots
        self._joints = [self._freejoint(f"robot_{n}") for n in range(robots)]
        wheels = [[self.model.joint(f"{side}_{n}") for side in ("left", "right")] for n in range(robots)]
        self._wheels = [[int(wheel.qposadr[0]) for wheel in pair] for pair in wheels]
        self._spins = [[int(wheel.dofadr[0]) for wheel in pair] for pair in wheels]
        motors = [self.model.actuator(f"left_{n}").id for n in range(robots)]
        self._motors = [slice(first, first + 2) for first in motors]
        self._chassis = [int(self.model.geom(f"chassis_{n}").id) for n in range(robots)]
        self._owners = {geom: n for n, geom in enumerate(self._chassis)}
        self._people = np.array([self.model.geom(f"person_{n}").id for n in range(self.model.nmocap)], dtype=np.intp)
        self._aside = [int(self.model.joint(f"aside_{n}").qposadr[0]) for n in range(robots) if sideways]
        self._trees = [int(self.model.body_treeid[self.model.body(f"robot_{n}").id]) for n in range(robots)]
        self.reset()

    def reset(self) -> None:
        """Reset to the start, at rest."""
        self._still = False
        self.touching = frozenset[int]()
        """The robots whose chassis touches something: a wall, a box, an obstacle, another robot."""
        self._may_rest = [True] * self._robots
        self.model.tree_sleep_policy[self._trees] = _SLEEP.mjSLEEP_ALLOWED
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_forward(self.model, self.data)

    def step(self, count: int) -> None:
        """Advance by a number of time steps."""
        if self._still:
            return
        mujoco.mj_step(self.model, self.data, count)
        self._still = not (self.data.ntree_awake or self.model.nmocap)
        owners, pairs = self._owners, self.data.contact.geom.tolist() if self.data.ncon else ()
        self.touching = frozenset(owners[geom] for pair in pairs for geom in pair if geom in owners)
        for robot in self.touching:
            self._let_rest(robot, rest=False)

    def set_wheel_speeds(self, robot: int, left: float, right: float) -> None:
        """Set the target speeds of the motors, rad/s."""
        self._let_rest(robot, rest=left == right == 0.0)
        self.data.ctrl[self._motors[robot]] = (left, right)

    def set_velocity(self, robot: int, forward: float, left: float, turn: float) -> None:
        """Set the velocity that the wheels of a robot that drives sideways give it: m/s, rad/s."""
        self._let_rest(robot, rest=forward == left == turn == 0.0)
        motors = self._motors[robot]
        self.data.ctrl[motors.stop : motors.stop + 4] = (left, forward, left, turn)

    def _let_rest(self, robot: int, *, rest: bool) -> None:
        """Let MuJoCo skip a robot that has come to rest, or not: contacts of those that it skips are not known."""
        rest = rest and robot not in self.touching
        if rest == self._may_rest[robot]:
            return
        self._may_rest[robot], v = rest, self._joints[robot][1]
        self.model.tree_sleep_policy[self._trees[robot]] = _SLEEP.mjSLEEP_ALLOWED if rest else _SLEEP.mjSLEEP_NEVER
        if not rest and self.data.qvel[v] == 0.0:
            self.data.qvel[v], self._still = _TINY, False  # any speed wakes it

    def rolled_aside(self, robot: int) -> float:
        """Return how far the wheels rolled to the left, m; 0 for a robot that does not drive sideways."""
        return float(self.data.qpos[self._aside[robot]]) if self._aside else 0.0

    def wheel_angles(self, robot: int) -> tuple[float, float]:
        """Return the angles of the left and right wheel, rad, forward is positive."""
        left, right = self._wheels[robot]
        return float(self.data.qpos[left]), float(self.data.qpos[right])

    def wheel_speeds(self, robot: int) -> tuple[float, float]:
        """Return the speeds of the left and right wheel, rad/s."""
        left, right = self._spins[robot]
        return float(self.data.qvel[left]), float(self.data.qvel[right])

    def state(self) -> npt.NDArray[np.float64]:
        """A copy of all positions; see `restore_state`."""
        data = self.data
        return np.concatenate((data.qpos, data.mocap_pos.ravel(), data.mocap_quat.ravel()))

    def move_people(self, places: npt.NDArray[np.float64], headings: Sequence[float]) -> None:
        """Move people to positions (n, 2) with headings (rad)."""
        self.data.mocap_pos[:, :2] = places
        halves = 0.5 * np.asarray(headings)
        self.data.mocap_quat[:, 0], self.data.mocap_quat[:, 3] = np.cos(halves), np.sin(halves)

    def touched_people(self, robot: int) -> frozenset[int]:
        """The people that a robot's chassis touches, by number."""
        if not len(self._people) or not self.data.ncon:
            return frozenset()
        pairs = self.data.contact.geom
        touched = pairs[(pairs == self._chassis[robot]).any(axis=1)]
        return frozenset(np.flatnonzero(np.isin(self._people, touched)).tolist())

    def pose(self, robot: int) -> Pose2:
        """Return the pose of a robot's base_footprint in the map."""
        q = self._joints[robot][0]
        x, y, _, a, b, c, d = self.data.qpos[q : q + 7].tolist()
        return Pose2(x, y, yaw_of_quaternion(b, c, d, a))  # MuJoCo's order is w, x, y, z

    def velocity(self, robot: int) -> tuple[float, float, float]:
        """Forward, to the left (m/s) and yaw rate (rad/s), in the robot's own frame."""
        v = self._joints[robot][1]
        vx, vy, _, _, _, turn = self.data.qvel[v : v + 6].tolist()
        yaw = self.pose(robot)[2]
        c, s = math.cos(yaw), math.sin(yaw)
        return c * vx + s * vy, c * vy - s * vx, turn

    def motion(self, robot: int) -> BodyMotion:
        """Return the motion of a robot's base_footprint in three dimensions."""
        q, v = self._joints[robot]
        (a, b, c, d), speeds = self.data.qpos[q + 3 : q + 7].tolist(), self.data.qvel[v : v + 6].tolist()
        return BodyMotion((b, c, d, a), tuple(speeds[:3]), tuple(speeds[3:]))

    def touches(self, robot: int) -> list[npt.NDArray[np.float64]]:
        """Return contacts of a robot's chassis: for each thing the points, shape (points, 2), m in base_footprint."""
        pairs = self.data.contact.geom
        rows = (pairs == self._chassis[robot]).any(axis=1)
        points = self.pose(robot).inverse().transform_points(self.data.contact.pos[rows, :2])
        things = pairs[rows].sum(axis=1)  # one of the two is the chassis: the sums differ as the others do
        return [points[things == thing] for thing in np.unique(things)]

    def blocked(self, robot: int) -> str | None:
        """Describe an object that a robot's chassis touches; None when it touches nothing."""
        return self._neighbour(self._chassis[robot])

    def move_robot(self, robot: int, pose: tuple[float, float, float]) -> str | None:
        """Move a robot, at rest. Returns what blocks the pose, in which case nothing has changed."""
        return self._place(f"robot_{robot}", f"chassis_{robot}", pose)

    def move_obstacle(self, name: str, pose: tuple[float, float, float]) -> str | None:
        """Move an obstacle, at rest. Returns what blocks the pose, in which case nothing has changed."""
        return self._place(f"obstacle/{name}", f"obstacle/{name}", pose)

    def _place(self, body: str, geom: str, pose: tuple[float, float, float]) -> str | None:
        q, v = self._freejoint(body)
        before = np.empty(mujoco.mj_stateSize(self.model, _STATE))
        mujoco.mj_getState(self.model, self.data, before, _STATE)
        self._still = False
        x, y, yaw = pose
        qx, qy, qz, qw = quaternion_of_yaw(yaw)
        self.data.qpos[q : q + 7] = (x, y, self.model.qpos0[q + 2], qw, qx, qy, qz)
        self.data.qvel[v : v + 6] = 0.0
        mujoco.mj_forward(self.model, self.data)
        in_the_way = self._neighbour(self.model.geom(geom).id)
        if in_the_way is not None:
            mujoco.mj_setState(self.model, self.data, before, _STATE)
            mujoco.mj_forward(self.model, self.data)
        return in_the_way

    def _neighbour(self, geom: int) -> str | None:
        """Describe an object that a shape penetrates, except the floor."""
        floor = self.model.geom("floor").id
        for pair in self.data.contact.geom.tolist():
            if geom in pair and floor not in pair:
                name = str(self.model.geom(pair[0] if pair[1] == geom else pair[1]).name)
                kind, _, rest = name.partition("/")
                return "a wall" if kind == "wall" else rest if rest else name.replace("chassis", "robot")
        return None

    def _freejoint(self, name: str) -> tuple[int, int]:
        joint = self.model.joint(name)
        return int(joint.qposadr[0]), int(joint.dofadr[0])


def restore_state(model: mujoco.MjModel, data: mujoco.MjData, state: npt.NDArray[np.float64]) -> None:
    """Restore the positions of `Physics.state` of the same model."""
    data.qpos[:], places, turns = np.split(state, (model.nq, model.nq + 3 * model.nmocap))
    data.mocap_pos[:], data.mocap_quat[:] = places.reshape(-1, 3), turns.reshape(-1, 4)
