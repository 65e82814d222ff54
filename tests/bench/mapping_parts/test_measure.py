from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from bench.mapping_parts.log import Log, chain, steps_of, with_poor_sensors
from bench.mapping_parts.measure import Fit, best_fit, errors_after_fit, relation_errors, score_map

from ur.worlds.map_file import MapFile, MapImage
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2

CIRCLE = np.array([(5.0 * math.cos(a), 5.0 * math.sin(a), a + math.pi / 2.0) for a in np.arange(0.0, 13.0, 0.1)])


def moved(path: np.ndarray, fit: Fit) -> np.ndarray:
    return np.column_stack((fit.apply(path[:, :2]), path[:, 2] + fit.yaw))


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
    shifts, turns = relation_errors(np.vstack((path, path)), np.vstack((CIRCLE, CIRCLE)))
    assert len(shifts) > 0
    assert shifts.max() == pytest.approx(0.3, abs=1e-6)
    assert turns.max() < 1e-6


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
