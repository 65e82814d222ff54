"""The whole first drive on a bus: goals are reached, and the same goals give the same path."""

from __future__ import annotations

import math

import pytest
from tests.ur_nodes.first_drive.drive import FirstDrive
from tests.ur_nodes.first_drive.stage import fingerprint

GOALS = ((0.8, 0.4, 1.57), (0.2, 0.0, 0.0))


def drive_to_goals(seed: int) -> str:
    """Drive to GOALS; a digest of commands, estimates and true poses."""
    drive = FirstDrive(seed=seed)
    for x, y, yaw in GOALS:
        end = drive.go(x, y, yaw)
        assert (end.state, end.text) == ("succeeded", "goal reached")
        assert math.dist(drive.truth.pose[:2], (x, y)) < 0.15
        assert math.dist(drive.truth.pose[:2], drive.estimates[-1].pose[:2]) < 0.3
    assert max(command.forward for command in drive.commands) == pytest.approx(0.5, abs=0.1)
    assert [node.ended for node in drive.bus.nodes.values()] == [None] * len(drive.bus.nodes)
    return fingerprint([*drive.commands, *drive.estimates, *drive.truths])


def test_same_goals_give_the_same_path_to_the_last_bit() -> None:
    first = drive_to_goals(1)
    assert drive_to_goals(1) == first
    assert drive_to_goals(2) != first
