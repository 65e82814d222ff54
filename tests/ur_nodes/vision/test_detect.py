import math
from typing import Any

import cv2
import gtsam
import numpy as np
import numpy.typing as npt
import pytest
from tests.ur_nodes.vision.synthetic import CAMERA, HEIGHT, WIDTH

from ur_nodes.geometry.rigid import Floats, angle_between, from_angles
from ur_nodes.ports.values import Calibration
from ur_nodes.vision.detect import (
    PIXEL_NOISE,
    CameraModel,
    Detector,
    Sizes,
    camera_model,
    corner_points,
    estimate_poses,
)

SIZE = 0.2
FRONT = from_angles((0.1, -0.05, 1.0), (math.pi + 0.5, 0.2, 0.3))


def corners_of(pose: Floats, camera: CameraModel = CAMERA, size: float = SIZE) -> Floats:
    turn = cv2.Rodrigues(pose[:3, :3])[0]
    points: Any = cv2.projectPoints(corner_points(size), turn, pose[:3, 3], camera.matrix, camera.distortion)[0]
    return np.asarray(points, np.float64).reshape(4, 2)


def draw(poses: dict[int, Floats], dictionary: str = "5X5_1000") -> npt.NDArray[np.uint8]:
    """A picture of fiducials: each warped onto white, four times as large and then made smaller for smooth edges."""
    known = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{dictionary}"))
    picture = np.full((4 * HEIGHT, 4 * WIDTH), 200, np.uint8)
    for number, pose in poses.items():
        marker = np.pad(cv2.aruco.generateImageMarker(known, number, 70), 10, constant_values=255)
        # A corner lies between pixels; pixels are counted from their centres, here and four times as large.
        target = (corners_of(pose) + 0.5) * 4 - 0.5
        source = np.array([[9.5, 9.5], [79.5, 9.5], [79.5, 79.5], [9.5, 79.5]])
        warp = cv2.getPerspectiveTransform(source.astype(np.float32), target.astype(np.float32))
        whole = (4 * WIDTH, 4 * HEIGHT)
        seen = cv2.warpPerspective(np.full_like(marker, 255), warp, whole)
        picture = np.where(seen > 127, cv2.warpPerspective(marker, warp, whole), picture)
    return np.asarray(cv2.resize(picture, (WIDTH, HEIGHT), interpolation=cv2.INTER_AREA), np.uint8)


def test_fiducials_are_found_with_their_poses() -> None:
    poses = {7: FRONT, 3: from_angles((-0.3, 0.1, 1.5), (math.pi - 0.6, -0.3, -2.0))}
    found = Detector("5X5_1000", Sizes(SIZE)).detect(draw(poses), CAMERA)
    assert [each.id for each in found] == [3, 7]
    for each in found:
        assert np.abs(each.corners - corners_of(poses[each.id])).max() < 0.6
        best = each.candidates[0]
        assert np.linalg.norm(best.pose[:3, 3] - poses[each.id][:3, 3]) < 0.015
        assert angle_between(best.pose, poses[each.id]) < 0.05
        assert best.error < 0.3


def test_sizes_and_numbers_to_ignore_are_kept() -> None:
    picture = draw({7: FRONT, 3: from_angles((-0.3, 0.1, 1.5), (math.pi, 0.0, 0.0))})
    (only,) = Detector("5X5_1000", Sizes(SIZE, {7: 2 * SIZE}, frozenset({3}))).detect(picture, CAMERA)
    assert only.id == 7
    assert only.candidates[0].pose[2, 3] == pytest.approx(2.0, abs=0.05)  # twice as large, twice as far


def test_without_calibration_there_are_corners_and_no_poses() -> None:
    (found,) = Detector("5X5_1000", Sizes(SIZE)).detect(draw({7: FRONT}), None)
    assert found.candidates == ()
    assert found.area > 1000.0


def test_nothing_is_found_with_another_dictionary_or_in_an_empty_picture() -> None:
    assert Detector("7X7_50", Sizes(SIZE)).detect(draw({7: FRONT}), CAMERA) == ()
    assert Detector("5X5_1000", Sizes(SIZE)).detect(np.zeros((HEIGHT, WIDTH, 3), np.uint8), CAMERA) == ()


def test_distortion_of_the_lens_is_taken_out() -> None:
    bent = CameraModel(CAMERA.matrix, np.array([0.2, -0.5, 0.001, 0.002, 0.1]))
    (best, *_) = estimate_poses(corners_of(FRONT, bent), SIZE, bent)
    assert np.allclose(best.pose, FRONT, atol=1e-4)
    (wrong, *_) = estimate_poses(corners_of(FRONT, bent), SIZE, CAMERA)
    assert not np.allclose(wrong.pose, FRONT, atol=1e-3)


def test_square_seen_from_the_front_has_two_poses_that_explain_it_alike() -> None:
    far = from_angles((0.0, 0.0, 3.0), (math.pi + 0.25, 0.0, 0.0))
    noise = np.random.default_rng(3).normal(0.0, 0.3, (4, 2))
    first, second = estimate_poses(corners_of(far) + noise, SIZE, CAMERA)
    assert first.error <= second.error < 1.0
    assert angle_between(first.pose, second.pose) > 0.3
    assert min(angle_between(far, each.pose) for each in (first, second)) < 0.2


def test_covariance_is_that_of_repeated_measurements() -> None:
    random, offs = np.random.default_rng(1), []
    exact = corners_of(FRONT)
    for _ in range(300):
        best = estimate_poses(exact + random.normal(0.0, 0.3, (4, 2)), SIZE, CAMERA)[0]
        off = gtsam.Pose3.Logmap(gtsam.Pose3(FRONT).between(gtsam.Pose3(best.pose)))
        offs.append(off @ np.linalg.solve(best.covariance * (0.3 / PIXEL_NOISE) ** 2, off))
    assert np.mean(offs) == pytest.approx(6.0, abs=0.8)  # chi squared with six degrees of freedom


def test_camera_without_calibration_is_none() -> None:
    square, projection = (0.0,) * 9, (0.0,) * 12
    assert camera_model(Calibration(0, "camera", 4, 4, "", (), square, square, projection)) is None
    matrix, distortion = (500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0), (0.1, 0.2, 0.0, 0.0, 0.0)
    camera = camera_model(Calibration(0, "camera", 4, 4, "plumb_bob", distortion, matrix, square, projection))
    assert camera is not None
    assert (camera.matrix[1, 1], camera.distortion.tolist()) == (510.0, [0.1, 0.2, 0.0, 0.0, 0.0])
