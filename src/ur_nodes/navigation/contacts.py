"""Detection of what no lidar sees and stops the robot: pressed bumpers, wheels that slip, and wheels that stand."""

import math
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ur_nodes.costmap.touched import BumperSource, touched_points
from ur_nodes.geometry.hull import hull_of_outline
from ur_nodes.geometry.motion_witness import MotionWitness
from ur_nodes.geometry.pose import Pose2, rotate, wrap_angle
from ur_nodes.navigation.steering.speed_profile import AT_REST, DriveVelocity
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.transforms import seconds_of
from ur_nodes.ports.values import Imu

_SLIPPED = 0.2  # m or rad that wheels turn in vain
_TURNED = 0.4  # rad that wheels claim, of which a gyroscope has to see a part
_CONFIRMED = 0.3  # of it
_STANDING = 2.0  # s under a command
_MOVES, _TURNS = 0.03, 0.1  # m, rad: more in that time is no standing
_STILL = 0.002  # m, rad in a control period
_SELF = "navigation"  # the source of the mux that this node is
_BESIDE = 0.2  # m from the outline: what is so near may stop the robot
_SLOW, _SLOW_TURN = 0.05, 0.2  # m/s, rad/s: slower commands may not overcome friction


@dataclass(slots=True)
class StallDetector:
    """Detects from commands, odometry, scans and a gyroscope that wheels turn in vain, or stand under a command."""

    witness: MotionWitness = field(default_factory=MotionWitness)
    _since: float = 0.0  # s: from here on the robot stands under a command
    _from: Pose2 | None = None
    _gyro: float | None = None  # rad that the gyroscope has turned since then
    _claimed: float = 0.0  # and the wheels, rad
    _last: Pose2 | None = None

    def restart(self) -> None:
        """Forget what was before, as after a stall."""
        self.witness.restart()
        self._from = self._last = self._gyro = None
        self._claimed = 0.0

    def add_turn(self, angle: float) -> None:
        """Take what the gyroscope has turned since the last call, rad."""
        if angle:  # a unit that is broken says 0
            self._gyro = (self._gyro or 0.0) + angle

    def step(self, now: float, wanted: DriveVelocity, odometry: Pose2) -> str:
        """Return how the robot is stalled at a time (s) with a command in force, '' if it is not."""
        if wanted == AT_REST:
            self.restart()
            return ""
        last, self._last = self._last or odometry, odometry
        self._claimed += wrap_angle(odometry.yaw - last.yaw)
        confirmed = abs(self._gyro or 0.0) > _CONFIRMED * abs(self._claimed)
        turning = abs(self._claimed) > _TURNED
        if turning and self._gyro is not None and not (confirmed or self.witness.moves):
            return "its wheels turn and it does not"
        if self.witness.slipped > _SLIPPED and not (turning and self._gyro is not None):
            return "its wheels turn and it does not move"
        if turning:
            self._claimed, self._gyro = 0.0, None if self._gyro is None else 0.0
        begin = self._from
        fast = math.hypot(wanted.speed, wanted.left) >= _SLOW or abs(wanted.turn) >= _SLOW_TURN
        if (
            begin is None
            or not fast
            or math.dist(begin[:2], odometry[:2]) > _MOVES
            or abs(wrap_angle(odometry.yaw - begin.yaw)) > _TURNS
        ):
            self._from, self._since = odometry, now
        return "its wheels stand still under a command" if now - self._since > _STANDING else ""


@dataclass(frozen=True, slots=True, eq=False)
class Contact:
    """A text about what stopped the robot, and the points (n, 2) in its frame where it touches something."""

    text: str
    points: NDArray[np.float64]


class ContactSense:
    """Subscribes to bumpers and an inertial unit; `step` returns each contact once."""

    def __init__(
        self,
        node: Node,
        base_frame: str,
        outline: NDArray[np.float64],
        bumpers: tuple[BumperSource, ...],
        imu: str,
        mux: str,
    ) -> None:
        self.detector = StallDetector()
        self._node, self._base_frame, self._outline = node, base_frame, outline
        self._hull = hull_of_outline([(x, y) for x, y in outline.tolist()])
        self._pressed: dict[str, BumperSource] = {}
        self._new: BumperSource | None = None
        self._imu_at = 0
        self._driver = _SELF
        node.subscribe(f"{mux}/active", str, self._on_active, Quality.LATCHED)
        for bumper in bumpers:
            for quality in (Quality.LATCHED, Quality.NEWEST):  # drivers of others may not latch it
                node.subscribe(bumper.topic, bool, partial(self._on_bumper, bumper), quality)
        if imu:
            node.subscribe(imu, Imu, self._on_imu)

    @property
    def held(self) -> str:
        """Return which bumpers are pressed now, '' for none."""
        names = ", ".join(self._node.resolve(topic) for topic in self._pressed)
        return f"{names} stays pressed" if names else ""

    def see(self, odometry: Pose2, points: NDArray[np.float64], sensor: Pose2) -> None:
        """Take a scan, as `MotionWitness.update` does."""
        self.detector.witness.update(odometry, points, (sensor.x, sensor.y))

    def step(
        self, now: float, wanted: DriveVelocity, odometry: Pose2 | None, moving: DriveVelocity, widen: float = 0.0
    ) -> Contact | None:
        """Return a new contact of a robot with a command in force (AT_REST: none), and a velocity of its own.

        Its points reach `widen` m further to both sides than the robot.
        """
        bumper, self._new = self._new, None
        wanted = wanted if self._driver == _SELF else AT_REST
        velocity = moving if wanted == AT_REST else wanted
        if bumper is not None and max(map(abs, velocity)) > _STILL:
            text = f"{self._node.resolve(bumper.topic)} was pressed"
            return Contact(text, touched_points(self._outline, velocity, bumper, widen))
        stalled = self.detector.step(now, wanted, odometry) if odometry is not None else ""
        if not stalled:
            return None
        self.detector.restart()
        return Contact(stalled, touched_points(self._outline, wanted, widen=widen))

    def beside(self, marks: NDArray[np.float64], widen: float) -> NDArray[np.float64] | None:
        """Return the points (n, 2) of a contact with the nearest of marks (n, 2) in the robot's frame, None if far."""
        if not len(marks) or (away := self._hull.distances(marks)).min() > _BESIDE:
            return None
        x, y = marks[away.argmin()].tolist()
        return touched_points(self._outline, (x, 0.0, y), widen=widen)

    def _on_active(self, source: str) -> None:
        self._driver = source

    def _on_bumper(self, bumper: BumperSource, pressed: bool) -> None:
        if pressed and bumper.topic not in self._pressed:
            self._pressed[bumper.topic] = self._new = bumper
        elif not pressed:
            self._pressed.pop(bumper.topic, None)

    def _on_imu(self, imu: Imu) -> None:
        passed, self._imu_at = seconds_of(imu.stamp - self._imu_at), imu.stamp
        mount = self._node.transforms.find(self._base_frame, imu.frame)
        if mount is not None and 0.0 < passed < 0.5:
            self.detector.add_turn(rotate(mount.rotation, imu.turning)[2] * passed)
