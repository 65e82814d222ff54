"""The calibration of a camera from views of a chessboard, and its quality."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ur.source.diagnostic import user_error
from ur_nodes.camera.calibration.board import Board
from ur_nodes.camera.calibration.session import BoardView, list_tilts
from ur_nodes.ports.values import Calibration

LARGEST_ERROR = 1.0  # pixels
FEWEST_TILTS = 2
LARGEST_DEVIATION = 0.01  # of the focal lengths, relative
_OUTLIER = 3.0  # times the median of the views' errors


@dataclass(frozen=True, slots=True)
class CalibrationResult:
    """A calibration and its quality.

    `error` is its reprojection error (root mean square, pixels), `deviation` the relative standard deviation of its
    focal lengths; `used` of `given` views were used. `tilts` is the number of ways in which the board was tilted:
    without tilts the focal length cannot be distinguished from the distance.
    """

    calibration: Calibration
    error: float
    deviation: float
    used: int
    given: int
    tilts: int

    @property
    def problem(self) -> str:
        """Return why the calibration should not be used, and what to do; '' for a good one."""
        if self.error > LARGEST_ERROR:
            return (
                f"the reprojection error is {self.error:.2f} pixels, expected at most {LARGEST_ERROR:g}:"
                " glue the board on something flat, hold it still, and begin again"
            )
        if self.tilts < FEWEST_TILTS:
            return "the board was not tilted enough: begin again, and tilt it to all sides, by 30 to 45 degrees"
        if self.deviation > LARGEST_DEVIATION:
            return (
                f"the focal length is uncertain by {100 * self.deviation:.1f} %, expected at most"
                f" {100 * LARGEST_DEVIATION:g} %: begin again, and tilt the board more, by 30 to 45 degrees"
            )
        return ""


def solve(views: Sequence[BoardView], board: Board) -> CalibrationResult | None:
    """Calibrate from at least three views of pictures of one size; None if there is no solution.

    Views with an error far above that of others, as of a moved board, are left out.
    """
    import cv2

    kept = list(views)
    if len(kept) < 3:
        return None
    try:
        found = _solve(kept, board)
        errors = np.ravel(found[7])
        good = [view for view, each in zip(kept, errors, strict=True) if each <= _OUTLIER * np.median(errors)]
        if 3 <= len(good) < len(kept):
            kept, found = good, _solve(good, board)
    except cv2.error:
        return None
    matrix, distortion, deviations = found[1], np.ravel(found[2])[:5], np.ravel(found[5])
    if not np.isfinite(matrix).all() or not np.isfinite(distortion).all() or matrix[0, 0] <= 0.0:
        return None
    size = views[0].width, views[0].height
    projection = np.zeros((3, 4))
    projection[:, :3] = cv2.getOptimalNewCameraMatrix(matrix, distortion, size, 0.0)[0]
    calibration = Calibration(
        0,
        "",
        *size,
        "plumb_bob",
        tuple(map(float, distortion)),
        tuple(map(float, matrix.ravel())),
        tuple(map(float, np.eye(3).ravel())),
        tuple(map(float, projection.ravel())),
    )
    tilts = {face for view in kept for face in list_tilts(view, board)}
    deviation = float(max(deviations[0] / matrix[0, 0], deviations[1] / matrix[1, 1]))
    return CalibrationResult(calibration, float(found[0]), deviation, len(kept), len(views), len(tilts))


def solve_or_fail(views: Sequence[BoardView], board: Board) -> CalibrationResult:
    """Calibrate as `solve` does. Raises UserError if there is no solution, or none good enough."""
    result = solve(views, board)
    if result is None or result.problem:
        reason = result.problem if result else f"{len(views)} views have no solution: take more, all tilted"
        raise user_error(f"the camera is not calibrated, nothing was changed: {reason}", rule="bad-calibration")
    return result


def describe_result(result: CalibrationResult) -> str:
    """Describe a calibration and its quality in two lines."""
    matrix = result.calibration.matrix
    return (
        f"reprojection error {result.error:.2f} pixels from {result.used} of {result.given} views;"
        f" focal length uncertain by {100 * result.deviation:.2f} %\n"
        f"focal lengths {matrix[0]:.1f} and {matrix[4]:.1f} pixels, centre {matrix[2]:.1f} {matrix[5]:.1f},"
        f" pictures of {result.calibration.width} x {result.calibration.height}"
    )


def _solve(views: Sequence[BoardView], board: Board) -> Any:
    import cv2

    points = [board.points.astype(np.float32)] * len(views)
    corners = [view.corners.astype(np.float32).reshape(-1, 1, 2) for view in views]
    size = views[0].width, views[0].height
    # The third radial coefficient of ordinary lenses is lost in noise.
    return cv2.calibrateCameraExtended(  # type: ignore[call-overload]  # its stubs refuse None
        points, corners, size, None, None, flags=cv2.CALIB_FIX_K3
    )
