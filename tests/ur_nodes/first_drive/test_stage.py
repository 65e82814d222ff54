"""The simulated robot on a bus: one time for all, and the same run for the same seed."""

from itertools import pairwise

import numpy as np
import pytest
from tests.ur_nodes.first_drive.stage import DrivenStage
from tests.ur_nodes.lock_step.digest import fingerprint

from ur_nodes.ports.services import AskMap
from ur_nodes.ports.values import Map, Odometry, Scan


def recorded_drive(seed: int) -> str:
    stage = DrivenStage("maze", seed=seed)
    scans, odometry = stage.record("scan", Scan), stage.record("odom", Odometry)
    transforms = stage.record("/tf", tuple)
    stage.drive(0.4, 0.3, 3.0)
    stage.drive(0.2, -0.5, 2.0)
    stage.bus.run(1.0)
    assert len(scans) == pytest.approx(60, abs=1)
    return fingerprint([*scans, *odometry, *transforms])


def test_same_seed_and_commands_give_the_same_run_to_the_last_bit() -> None:
    first = recorded_drive(3)
    assert recorded_drive(3) == first
    assert recorded_drive(4) != first


def test_bus_is_the_clock_of_the_simulator() -> None:
    stage = DrivenStage("maze")
    scans = stage.record("scan", Scan)
    arrived: list[int] = []
    stage.client.subscribe("scan", Scan, lambda _scan: arrived.append(stage.bus.now))
    stage.bus.run(20.0)
    assert [scan.stamp for scan in scans] == arrived
    assert {b.stamp - a.stamp for a, b in pairwise(scans)} == {100_000_000}


def test_sensors_have_frames_on_the_robot() -> None:
    stage = DrivenStage("maze")
    tree = stage.client.transforms
    stage.bus.run(0.5)
    lidar = stage.base.lidar
    assert lidar is not None
    found = tree.find("odom", lidar.frame)
    assert found is not None
    assert found[:3] == pytest.approx(lidar.pose[:3], abs=0.001)


def test_map_of_the_world_is_served() -> None:
    stage = DrivenStage("office")
    stage.serve_map()
    value = stage.ask("static_map", AskMap()).value
    assert isinstance(value, Map)
    assert value.grid.values_at(np.array(stage.truth.pose[:2]), outside=-1) == 0
