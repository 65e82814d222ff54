"""A map of fiducials that is built or only read, and the robot's pose on it: the decisions of fiducial_slam."""

import math
from collections import Counter
from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.geometry.rigid import Floats, from_pose
from ur_nodes.ports.fiducials import FiducialCorners, SeenFiducials
from ur_nodes.ports.values import PoseEstimate
from ur_nodes.vision.detect import CameraModel, Sizes, estimate_poses
from ur_nodes.vision.estimation.graph import without_twins
from ur_nodes.vision.estimation.localise import FiducialLocaliser
from ur_nodes.vision.estimation.mapping import FiducialMapper
from ur_nodes.vision.estimation.observation import Observation, make_observation
from ur_nodes.vision.fiducial_map import MapEntry

_WRONG = 20  # pictures in which something is wrong with a fiducial, before it is logged
_FARTHEST = 1e5  # pixels of a corner that a camera may see
_PLANAR = (3, 4, 2)  # x, y, heading among rotation and translation


@dataclass(frozen=True, slots=True)
class Moment:
    """The corners in a picture, its camera and where that is mounted, and the base in the frame of odometry."""

    seen: SeenFiducials
    camera: CameraModel
    mount: Pose3
    odometry: Pose2


@dataclass(frozen=True, slots=True)
class FiducialStep:
    """The pose of the frame of odometry in the map (None: not known), and lines for the log.

    `estimate` is the robot's pose, where the picture was of use.
    """

    correction: Pose2 | None
    estimate: PoseEstimate | None = None
    found: str = ""
    warnings: tuple[str, ...] = ()


class FiducialSlam:
    """Takes moments in their order. The same moments give the same map."""

    def __init__(
        self,
        map_frame: str,
        sizes: Sizes,
        estimator: FiducialMapper | FiducialLocaliser,
        known: tuple[MapEntry, ...] = (),
    ) -> None:
        """`known` is the map of a Localiser."""
        self._frame, self._sizes = map_frame, sizes
        self._estimator, self._known = estimator, known
        self._wrong: Counter[int] = Counter()
        self._changes = self._saved = 0

    def step(self, moment: Moment) -> FiducialStep:
        """Take the fiducials that are seen at a moment."""
        estimator, odometry = self._estimator, moment.odometry
        mount = from_pose(moment.mount)
        observed = [self._observe(each, moment.camera, mount) for each in moment.seen.fiducials]
        seen, twins = without_twins([each for each in observed if each])
        known_before = estimator.robot(odometry) is not None
        changed = estimator.add(odometry, seen)
        robot = estimator.robot(odometry)
        warnings = [
            *self._name(twins, "is often twice in one picture, expected each number once; it is overlooked there"),
            *self._name(
                estimator.contradicting,
                "is not where the map has it, expected it there: it was moved, or hangs twice; it is overlooked",
            ),
        ]
        self._changes += changed and isinstance(estimator, FiducialMapper)
        if robot is None:
            if known_before:
                warnings.append("lost: what is seen does not fit, or nothing was seen for long; looking for the robot")
            return FiducialStep(None, warnings=tuple(warnings))
        place = f"the robot is at {robot.x:.2f} {robot.y:.2f}, {math.degrees(robot.yaw):.0f} degrees"
        estimate = PoseEstimate(moment.seen.stamp, self._frame, robot, self._covariance(robot)) if changed else None
        return FiducialStep(robot.compose(odometry.inverse()), estimate, "" if known_before else place, tuple(warnings))

    def set_pose(self, pose: Pose2) -> None:
        """Set the robot's pose, on a map that is only read."""
        assert isinstance(self._estimator, FiducialLocaliser)
        self._estimator.set_pose(pose)

    def forget(self) -> None:
        """Search for the robot on the whole map, if the map is only read."""
        assert isinstance(self._estimator, FiducialLocaliser)
        self._estimator.forget()

    def clear(self) -> None:
        """Forget the map that is being built; the robot's pose stays."""
        assert isinstance(self._estimator, FiducialMapper)
        self._estimator = FiducialMapper(start=self._estimator.last or Pose2(0.0, 0.0, 0.0))
        self._changes += 1

    def poses(self) -> dict[int, Floats]:
        """The poses (4, 4) of the fiducials in the map, by number."""
        if isinstance(self._estimator, FiducialMapper):
            return self._estimator.fiducials
        return {entry.id: entry.pose for entry in self._known}

    def entries(self) -> tuple[MapEntry, ...]:
        """Return the map to save; one that is built is refined."""
        self._saved = self._changes
        if isinstance(self._estimator, FiducialLocaliser):
            return self._known
        self._estimator.refine()
        return self._estimator.entries()

    def unsaved(self) -> tuple[MapEntry, ...] | None:
        """Return the map to save; None if it has not changed since the last call."""
        return None if self._saved == self._changes else self.entries()

    def _observe(self, fiducial: FiducialCorners, camera: CameraModel, mount: Floats) -> Observation | None:
        number = fiducial.number
        if number in self._sizes.ignored or number < 0 or not (np.abs(fiducial.corners) < _FARTHEST).all():
            return None
        found = estimate_poses(fiducial.corners, self._sizes.of(number), camera)
        return make_observation(number, mount, found) if found else None

    def _name(self, numbers: Collection[int], what: str) -> Iterator[str]:
        """Return a line for each fiducial that has contradicted the map for long, once."""
        self._wrong.update(numbers)
        return (f"fiducial {number} {what}" for number in sorted(numbers) if self._wrong[number] == _WRONG)

    def _covariance(self, robot: Pose2) -> Floats:
        """The covariance (3, 3) of x, y and yaw along the axes of the map."""
        if isinstance(self._estimator, FiducialLocaliser):
            planar = self._estimator.covariance
        else:
            planar = self._estimator.covariance()[np.ix_(_PLANAR, _PLANAR)]
        c, s = math.cos(robot.yaw), math.sin(robot.yaw)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        rotated: Floats = turn @ planar @ turn.T
        return rotated
