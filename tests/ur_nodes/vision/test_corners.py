import math

import cv2
import numpy as np
import pytest
from tests.ur_nodes.vision.synthetic import CAMERA
from tests.ur_nodes.vision.test_detect import SIZE, corners_of, draw

from ur_nodes.geometry.rigid import Floats, from_angles
from ur_nodes.vision.detect import Detector, Sizes, refine_corners

VIEWS = [
    from_angles((x, 0.05 - x / 4, distance), (math.pi + tilt, tilt / 2, turn))
    for x, distance, tilt, turn in [
        (0.1, 1.0, 0.5, 0.3),
        (-0.3, 1.7, -0.6, 1.2),
        (0.4, 2.4, 0.4, -2.0),
        (0, 3, -0.5, 0.7),
    ]
]


def test_squares_come_out_neither_too_large_nor_too_small() -> None:
    grown = []
    for pose in VIEWS:
        (found,) = Detector("5X5_1000", Sizes(SIZE)).detect(draw({7: pose}), CAMERA)
        exact = corners_of(pose)
        outward = exact - exact.mean(axis=0)
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        grown.append(float(((found.corners - exact) * outward).sum(axis=1).mean()))
        assert np.abs(found.corners - exact).max() < 0.35
    assert abs(np.mean(grown)) < 0.06  # pixels; OpenCV's own refinement gives -0.3


@pytest.mark.parametrize("off", [(0.8, -0.5), (-1.0, 1.0)])
def test_corners_are_drawn_to_the_same_place_from_both_sides(off: tuple[float, float]) -> None:
    exact = corners_of(VIEWS[0])
    picture = draw({7: VIEWS[0]})
    assert np.abs(refine_corners(picture, exact + off) - exact).max() < 0.3


def test_corners_stay_where_there_is_no_edge() -> None:
    given: Floats = np.array([[10.0, 10.0], [50.0, 12.0], [48.0, 52.0], [9.0, 50.0]])
    flat = np.full((80, 80), 128, np.uint8)
    assert np.array_equal(refine_corners(flat, given), given)
    at_the_border = cv2.resize(flat, (30, 30))
    assert np.array_equal(refine_corners(np.asarray(at_the_border, np.uint8), given), given)
