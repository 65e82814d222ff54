import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench.mapping_parts.log import Log, chain, steps_of, with_poor_sensors
from bench.mapping_parts.measure import Fit, best_fit, confirmed_loops, errors_after_fit, relation_errors, score_map
from bench.mapping_parts.raw_log import read_raw_log
from tests.ur_nodes.slam.rooms import ANGLES, ROOM, ranges_at

from ur.worlds.map_file import MapFile, MapImage
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

CIRCLE = np.array([(5.0 * math.cos(a), 5.0 * math.sin(a), a + math.pi / 2.0) for a in np.arange(0.0, 13.0, 0.1)])


def moved(path: np.ndarray, fit: Fit) -> np.ndarray:
    return np.column_stack((fit.apply(path[:, :2]), path[:, 2] + fit.yaw))


def log_along(path: np.ndarray, loops: np.ndarray | None = None) -> Log:
    """A log without beams."""
    nothing = np.zeros((len(path), 0), dtype=np.float32)
    here = Pose2(0.0, 0.0, 0.0)
    return Log("round", np.arange(float(len(path))), nothing, np.zeros(0), here, (0.1, 12.0), path, path, loops)


def test_path_in_another_frame_has_no_error() -> None:
    path = moved(CIRCLE, Fit(1.2, 3.0, -4.0))
    assert best_fit(path[:, :2], CIRCLE[:, :2]).yaw == pytest.approx(-1.2)
    assert errors_after_fit(path, CIRCLE).max() < 1e-9


def test_error_of_one_pose_is_found() -> None:
    path = CIRCLE.copy()
    path[40, 0] += 0.5
    errors = errors_after_fit(path, CIRCLE)
    assert int(np.argmax(errors)) == 40
    assert errors[40] == pytest.approx(0.5, abs=0.02)


def test_relations_over_loops_show_an_error_between_two_rounds() -> None:
    path = CIRCLE.copy()
    path[63:] = moved(path[63:], Fit(0.0, 0.3, 0.0))
    rounds = np.vstack((CIRCLE, CIRCLE))
    shifts, turns = relation_errors(np.vstack((path, path)), log_along(rounds))
    assert len(shifts) > 0
    assert shifts.max() == pytest.approx(0.3, abs=1e-6)
    assert turns.max() < 1e-6


def test_loops_that_a_log_names_are_those_that_count() -> None:
    path = CIRCLE.copy()
    path[5] += (0.3, 0.4, 0.0)
    shifts, _ = relation_errors(path, log_along(CIRCLE, np.array([(2, 7), (1, 5)])))
    assert shifts == pytest.approx([0.0, 0.5])


def test_loops_are_confirmed_where_the_scans_agree_with_the_reference() -> None:
    poses = [Pose2(-1.0, 0.0, 0.0), Pose2(-0.6, 0.2, 0.3), Pose2(-0.7, 0.1, 3.0)]
    ranges = np.array([ranges_at(ROOM, pose, 0.01, number) for number, pose in enumerate(poses)], np.float32)
    loops = np.array([(0, 1), (0, 2)])  # the last scan looks the other way
    here = Pose2(0.0, 0.0, 0.0)
    true = np.array(poses)
    log = Log("room", np.arange(3.0), ranges, ANGLES, here, (0.1, 12.0), true, true, loops)
    assert confirmed_loops(log).tolist() == [[0, 1]]
    wrong = true + np.array([(0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.0, 0.0, 0.0)])
    assert not len(confirmed_loops(replace(log, reference=wrong)))


def test_raw_log_is_read_with_its_loops(tmp_path: Path) -> None:
    path = tmp_path / "hall.npz"
    ranges = np.array([[1.0, 40.0], [2.0, 3.0], [4.0, 5.0]])
    poses = np.zeros((3, 3))
    np.savez(path, t=[1.0, 1.5, 2.0], ranges=ranges, angles=[-0.1, 0.2], laser=[0.1, 0.0, 0.0], limits=[0.02, 30.0],
             odom=poses, truth=poses)  # fmt: skip
    path.with_suffix(".relations").write_text("1.0 1.5 0 0 0 0\n1.0 2.000001 0.5 0 0 1\n")
    log = read_raw_log(path)
    assert log.loops is not None
    assert log.loops.tolist() == [[0, 2]]
    assert np.isinf(log.ranges[0, 1])
    assert log.angles == pytest.approx([-0.1, 0.1])


def test_true_map_scores_one_and_a_shifted_one_less() -> None:
    walls = np.zeros((60, 60), dtype=bool)
    walls[[0, -1]] = walls[:, [0, -1]] = True
    file = MapFile(Path("box.png"), 0.05, (-1.5, -1.5, 0.4), False, 0.65, 0.25, "trinary")
    plan = MapImage(file, np.where(walls, 100, 0).astype(np.int8))
    angles = np.arange(0.0, 2.0 * math.pi, 0.01)
    centre = Fit(0.4, -1.5, -1.5).apply(np.array([(1.5, 1.5)]))[0]
    far = 1.45 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    log = Log("box", np.zeros(1), far[None].astype(np.float32), angles, Pose2(0.0, 0.0, 0.0), (0.1, 12.0),
              np.zeros((1, 3)), np.array([(*centre, 0.4)]))  # fmt: skip
    grid = Grid(np.where(walls, 100, 0).astype(np.int8), 0.05, Pose2(-1.5, -1.5, 0.4))
    assert score_map(grid, Fit(0.0, 0.0, 0.0), log, plan) == pytest.approx(1.0)
    assert score_map(grid, Fit(0.0, 0.2, 0.1), log, plan) < 0.6


def test_poor_odometry_is_long_and_turns() -> None:
    straight = np.column_stack((np.arange(0.0, 10.01, 0.1), np.zeros(101), np.zeros(101)))
    log = Log("line", np.arange(101.0), np.full((101, 8), 6.0, np.float32), np.linspace(-3.0, 3.0, 8),
              Pose2(0.0, 0.0, 0.0), (0.1, 12.0), straight, straight)  # fmt: skip
    poor = with_poor_sensors(log, 0)
    steps = steps_of(poor.odometry)
    assert np.hypot(steps[:, 0], steps[:, 1]).sum() == pytest.approx(10.5)
    assert steps[:, 2].sum() == pytest.approx(10.5 * math.radians(3.0), abs=1e-6)
    assert np.isinf(poor.ranges).all()
    assert len(poor.angles) < 8
    assert chain(steps, poor.odometry[0]) == pytest.approx(poor.odometry)
