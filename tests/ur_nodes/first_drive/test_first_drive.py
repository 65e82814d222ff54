"""The whole first drive on a bus: goals are reached, and the same goals give the same path."""

import math

import pytest
from tests.ur_nodes.first_drive.drive import FirstDrive
from tests.ur_nodes.lock_step.digest import fingerprint

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


def test_robot_that_is_carried_away_holds_its_goal_until_it_is_found_and_then_drives_there() -> None:
    drive = FirstDrive("office", seed=1)
    lost, holds = drive.record("amcl/lost", str), drive.record("move_base/hold", str)
    carried = drive.send_goal(3.5, -1.65)
    drive.bus.run(2.0)
    assert drive.place(9.0, -0.15, 1.0).success
    assert drive.bus.run_until(lambda: any(lost), 4.0)
    assert drive.bus.run_until(lambda: not lost[-1], 10.0)
    assert '"state": "held"' in "".join(holds)
    assert drive.bus.run_until(lambda: drive.states[carried].state == "succeeded", 120.0), drive.states
    assert math.dist(drive.truth.pose[:2], (3.5, -1.65)) < 0.15


def test_same_goals_give_the_same_path_to_the_last_bit() -> None:
    first = drive_to_goals(1)
    assert drive_to_goals(1) == first
    assert drive_to_goals(2) != first
