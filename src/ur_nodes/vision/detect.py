"""Detection of fiducials in a picture: numbers, corners, and poses relative to the camera.

The frame of a fiducial is at its centre: x to the right and y up as one reads it, z out of it towards the reader. That
of the camera is the optical one (REP 103). Pixels are counted from the centre of the first one, as in OpenCV.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field

import cv2
import numpy as np
import numpy.typing as npt

from ur_nodes.geometry.rigid import Floats, make_rigid, skew
from ur_nodes.ports.values import Calibration

# Corners of fiducials to a few hundredths of a pixel, without the bias that OpenCV's own refinement has.
# OpenCV traces the outermost dark pixels, so that a square comes out a third of a pixel too small on each side, and so
# 1 % too far away at 40 pixels: enough to stretch a whole map. Here each edge is a line through the places where the
# brightness changes across it, and a corner is where two such lines meet.


_STEP = 0.25  # pixels between samples across an edge
_REACH = 3.0  # pixels to either side of it at most, and at most nine tenths of a cell
_CELLS = 7.0  # along an edge of the usual dictionaries
_LEAST_CHANGE = 30.0  # of brightness, for an edge to count there
_LEAST_POINTS = 4
_FURTHEST = 3.0  # pixels that a corner may move


def refine_corners(grey: npt.NDArray[np.uint8], corners: Floats) -> Floats:
    """Refine the corners (4, 2) of a dark square on light ground; unchanged where its edges are not clear."""
    centre = corners.mean(axis=0)
    lines = [_fit_edge(grey, corners[k], corners[(k + 1) % 4], centre) for k in range(4)]
    refined: Floats = corners.copy()
    for k in range(4):
        before, after = lines[k - 1], lines[k]
        if before is None or after is None:
            return corners
        met = _meet(*before, *after)
        if met is not None and np.linalg.norm(met - corners[k]) < _FURTHEST:
            refined[k] = met
    return refined


def _fit_edge(grey: npt.NDArray[np.uint8], begin: Floats, end: Floats, centre: Floats) -> tuple[Floats, Floats] | None:
    """Return a point and a direction (2,) of the line through the brightness steps between two corners."""
    length = float(np.linalg.norm(end - begin))
    if length < 4.0:
        return None
    along = (end - begin) / length
    outward = np.array([along[1], -along[0]])
    outward = outward if outward @ (begin - centre) > 0.0 else -outward
    reach = min(_REACH, 0.9 * length / _CELLS)
    offsets = np.arange(-reach, reach + _STEP / 2.0, _STEP)
    places = begin + np.linspace(0.12, 0.88, max(6, int(length)))[:, None] * (end - begin)
    samples = (places[:, None, :] + offsets[None, :, None] * outward).astype(np.float32)
    values = cv2.remap(grey, samples[..., 0], samples[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    rises = np.clip(np.diff(np.asarray(values, np.float64), axis=1), 0.0, None)
    total = rises.sum(axis=1)
    clear = total > _LEAST_CHANGE
    if clear.sum() < _LEAST_POINTS:
        return None
    shift = (rises[clear] @ (offsets[:-1] + _STEP / 2.0)) / total[clear]
    points = places[clear] + shift[:, None] * outward
    middle = points.mean(axis=0)
    return middle, np.linalg.svd(points - middle)[2][0]


def _meet(a: Floats, along_a: Floats, b: Floats, along_b: Floats) -> Floats | None:
    """Return the intersection of two lines; None when they are nearly parallel."""
    matrix = np.stack([along_a, -along_b], axis=1)
    if abs(np.linalg.det(matrix)) < 0.1:
        return None
    met: Floats = a + np.linalg.solve(matrix, b - a)[0] * along_a
    return met


PIXEL_NOISE = 0.5
"""Standard deviation of the corners that are found, px."""

DICTIONARIES: tuple[str, ...] = tuple(sorted(name[5:] for name in dir(cv2.aruco) if name.startswith("DICT_")))


@dataclass(frozen=True, slots=True)
class CameraModel:
    """A pinhole camera: `matrix` (3, 3) in pixels, `distortion` (n,) as in OpenCV ("plumb_bob" or longer)."""

    matrix: Floats
    distortion: Floats


def camera_model(calibration: Calibration) -> CameraModel | None:
    """Return the camera of a calibration; None if it is not calibrated (REP 104: K is 0, or is not finite)."""
    lengths = calibration.matrix[0], calibration.matrix[4]
    if not all(map(math.isfinite, (*calibration.matrix, *calibration.distortion))) or min(lengths) <= 0.0:
        return None
    known = len(calibration.distortion) in (4, 5, 8, 12, 14)
    distortion = np.asarray(calibration.distortion, np.float64) if known else np.zeros(5)
    return CameraModel(np.asarray(calibration.matrix, np.float64).reshape(3, 3), distortion)


@dataclass(frozen=True, slots=True)
class CandidatePose:
    """A pose of a fiducial (4, 4) in the camera's frame that explains its corners.

    `error` is the rms distance in pixels between corners seen and expected. `covariance` (6, 6) is that of a small
    motion of the fiducial in its own frame: rotation (rad), then translation (m).
    """

    pose: Floats
    error: float
    covariance: Floats


@dataclass(frozen=True, slots=True)
class Detection:
    """A fiducial in a picture. `corners` (4, 2) in pixels, from the top left one clockwise as one reads the fiducial.

    `candidates` are its possible poses, the better one first: a square seen nearly from the front or from afar looks
    the same tilted one way or the other. None where the camera is not calibrated. `area` is in square pixels.
    """

    id: int
    corners: Floats
    size: float
    candidates: tuple[CandidatePose, ...]

    @property
    def area(self) -> float:
        """Return the area of the quadrilateral in square pixels (the shoelace formula)."""
        x, y = self.corners[:, 0], self.corners[:, 1]
        return float(abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))) / 2.0)


@dataclass(frozen=True, slots=True)
class Sizes:
    """Edges of fiducials in m: the `usual` one, exceptions by number, and fiducials to ignore."""

    usual: float
    special: Mapping[int, float] = field(default_factory=dict)
    ignored: frozenset[int] = frozenset()

    def of(self, number: int) -> float:
        """Return the edge of a fiducial in m."""
        return self.special.get(number, self.usual)


class Detector:
    """Finds fiducials of one dictionary (a name in DICTIONARIES)."""

    def __init__(self, dictionary: str, sizes: Sizes) -> None:
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_NONE  # see ur_nodes.vision.corners
        known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{dictionary}"))
        self._detector = cv2.aruco.ArucoDetector(known, parameters)
        self._sizes = sizes

    def detect(self, image: npt.NDArray[np.uint8], camera: CameraModel | None) -> tuple[Detection, ...]:
        """Find the fiducials in a grey or colour image, by number. Without a camera they have no poses."""
        grey = np.asarray(image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY), np.uint8)
        squares, numbers, _ = self._detector.detectMarkers(grey)
        found = []
        for corners, number in zip(squares, [] if numbers is None else np.ravel(numbers).tolist(), strict=True):
            if number not in self._sizes.ignored:
                size = self._sizes.of(number)
                points = refine_corners(grey, np.asarray(corners, np.float64).reshape(4, 2))
                poses = estimate_poses(points, size, camera) if camera else ()
                found.append(Detection(int(number), points, size, poses))
        return tuple(sorted(found, key=lambda each: each.id))


def corner_points(size: float) -> Floats:
    """Return the corners of a fiducial in its own frame (4, 3), in the order of Detection.corners."""
    half = size / 2.0
    return np.array([[-half, half, 0.0], [half, half, 0.0], [half, -half, 0.0], [-half, -half, 0.0]])


def estimate_poses(corners: Floats, size: float, camera: CameraModel) -> tuple[CandidatePose, ...]:
    """Estimate the possible poses of a square from its corners (4, 2), the better one first.

    Collins and Bartoli, Infinitesimal Plane-Based Pose Estimation (2014), gives both; each is then refined.
    """
    points = corner_points(size)
    matrix, distortion = camera.matrix, camera.distortion
    count, turns, shifts, _ = cv2.solvePnPGeneric(points, corners, matrix, distortion, flags=cv2.SOLVEPNP_IPPE_SQUARE)
    found = []
    for turn, shift in zip(turns[:count], shifts[:count], strict=True):
        if not (np.isfinite(turn).all() and np.isfinite(shift).all()):
            continue
        refined_turn, refined_shift = cv2.solvePnPRefineLM(points, corners, matrix, distortion, turn, shift)
        pose = make_rigid(np.asarray(cv2.Rodrigues(refined_turn)[0]), np.asarray(refined_shift))
        if pose[2, 3] > 0.0:
            expected = cv2.projectPoints(points, refined_turn, refined_shift, matrix, distortion)[0].reshape(4, 2)
            error = float(np.sqrt(np.mean(np.sum((expected - corners) ** 2, axis=1))))
            found.append(CandidatePose(pose, error, pose_covariance(pose, size, camera)))
    return tuple(sorted(found, key=lambda each: each.error))


def pose_covariance(pose: Floats, size: float, camera: CameraModel) -> Floats:
    """Propagate the noise of corners to a pose, to first order; see Candidate.covariance. Shape (6, 6)."""
    fx, fy = camera.matrix[0, 0], camera.matrix[1, 1]
    rows = []
    for point in corner_points(size):
        x, y, z = pose[:3, :3] @ point + pose[:3, 3]
        projection = np.array([[fx / z, 0.0, -fx * x / z**2], [0.0, fy / z, -fy * y / z**2]])
        motion = pose[:3, :3] @ np.hstack([-skew(point), np.eye(3)])
        rows.append(projection @ motion)
    jacobian = np.vstack(rows)
    information = jacobian.T @ jacobian / PIXEL_NOISE**2
    inverse: Floats = np.linalg.inv(information + 1e-9 * np.trace(information) * np.eye(6))
    return inverse
