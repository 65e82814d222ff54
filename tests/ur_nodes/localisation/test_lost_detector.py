import numpy as np
from tests.ur_nodes.navigation.synthetic import make_room, scan_points

from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.likelihood import BeamModel, make_field
from ur_nodes.localisation.lost_detector_node import LostDetector

HERE, THERE = Pose2(1.0, -0.6, 0.0), Pose2(5.5, 2.5, -2.0)


def detector_and_scans() -> tuple[LostDetector, np.ndarray, np.ndarray]:
    grid, chance = make_room(), np.random.default_rng(0)
    detector = LostDetector(make_field(grid, BeamModel(0.95, 0.05, 0.2, 2.0)))
    return detector, scan_points(grid, HERE, chance), scan_points(grid, THERE, chance)


def test_robot_is_lost_after_four_scans_of_another_place_and_found_after_five_that_fit() -> None:
    detector, fits, strange = detector_and_scans()
    assert detector.lost is None
    detector.judge(HERE, fits)
    assert detector.lost is False
    found = []
    for scan, pose in [(strange, Pose2(1.3, -0.6, 0.0))] * 4 + [(fits, HERE)] * 5:
        detector.judge(pose, scan)
        found.append(detector.lost)
    assert found == [False, False, False, True, True, True, True, True, False]


def test_pose_that_is_a_little_off_and_people_around_are_no_reason() -> None:
    detector, fits, _ = detector_and_scans()
    for step in range(40):
        crowd = fits * np.where(np.arange(len(fits)) % 3 == step % 3, 0.4, 1.0)[:, None]
        detector.judge(Pose2(1.0 + 0.05 * (-1) ** step, -0.6, 0.02), crowd)
        detector.judge(Pose2(1.0, -0.6, 0.9 * (step % 2)), fits[:3])
    assert detector.lost is False
