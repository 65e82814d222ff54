"""The adapter behind a driver whose devices are stand-ins, with the faults that devices have."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import IO

import pytest
from tests.base_contract import PACKAGE, load
from tests.devices.stand_ins.firmwares import MagniMotors, Xv11Lidar
from tests.devices.stand_ins.serial_stand_in import SerialStandIn
from tests.ros_session import RosSession

from ur_nodes.drivers.base_states import LONGEST_GAP

pytestmark = pytest.mark.ros
HERE = Path(__file__).parent
ADAPTER = PACKAGE / "n_driver_adapter" / "bin" / "driver_adapter"
ROUND_ROOM = ["laser", [2.0] * 360]  # as both stand-ins measure it, in the frame of the base
MOTORS, LIDAR = 38400, 115200  # baud


@pytest.fixture
def ros(tmp_path: Path) -> Iterator[RosSession]:
    started = RosSession(tmp_path, (sys.executable, str(HERE / "driver_client_node.py")))
    started.ask("listen", topics=["joint_states", "tf", "scan"])
    yield started
    started.close()


@pytest.fixture
def adapter(ros: RosSession) -> subprocess.Popen[str]:
    return ros.start(str(ADAPTER), "_base:=stage", "_publish_tf:=true", "_rename_scan:=true")


@pytest.fixture
def driver(ros: RosSession, adapter: subprocess.Popen[str], tmp_path: Path) -> subprocess.Popen[str]:
    assert adapter.poll() is None
    return ros.start(sys.executable, str(HERE / "serial_driver_node.py"), f"{tmp_path}/xv11", f"{tmp_path}/motors")


def wait_for(stream: IO[str] | None, text: str, count: int = 1) -> None:
    """Read lines until so many have the text."""
    assert stream
    while count:
        line = stream.readline()
        assert line, f"not reported: {text}"
        count -= text in line


def test_scan_stops_with_the_unplugged_lidar_and_goes_on_when_it_is_back(
    ros: RosSession, driver: subprocess.Popen[str], tmp_path: Path
) -> None:
    with SerialStandIn(tmp_path / "xv11", Xv11Lidar(), LIDAR):
        ros.ask("wait", topic="scan", count=2)
    wait_for(driver.stdout, "gone lidar")
    before = len(ros.ask("wait", topic="scan", count=0))
    with SerialStandIn(tmp_path / "xv11", Xv11Lidar(), LIDAR):
        scans = ros.ask("wait", topic="scan", count=before + 2)
    assert scans == [ROUND_ROOM] * len(scans)


@pytest.mark.parametrize(("old", "baud"), [(True, LIDAR), (False, 57600)], ids=["old firmware", "wrong baud rate"])
def test_lidar_that_is_not_understood_gives_no_scan_until_another_one_is_plugged_in(
    ros: RosSession, driver: subprocess.Popen[str], tmp_path: Path, old: bool, baud: int
) -> None:
    with SerialStandIn(tmp_path / "xv11", Xv11Lidar(old=old), baud):
        wait_for(driver.stdout, "rejected lidar", 100)  # more than a turn
        assert ros.ask("wait", topic="scan", count=0) == []
    with SerialStandIn(tmp_path / "xv11", Xv11Lidar(), LIDAR):
        assert ros.ask("wait", topic="scan", count=1)[0] == ROUND_ROOM


def test_wheels_turn_by_the_ticks_of_the_motor_board_and_not_by_its_faults(
    ros: RosSession, adapter: subprocess.Popen[str], driver: subprocess.Popen[str], tmp_path: Path
) -> None:
    step = 10 * 0.001 / load("stage", "").wheels.radius  # rad between two readings
    with SerialStandIn(tmp_path / "motors", MagniMotors(ticks=10), MOTORS, noise=b"\x7e\x00\x3c"):
        ros.ask("wait", topic="joint_states", count=5)
    wait_for(driver.stdout, "gone motors")
    before = len(ros.ask("wait", topic="joint_states", count=0))
    with SerialStandIn(tmp_path / "motors", MagniMotors(ticks=32767), MOTORS):  # 655 m/s: a broken counter
        wait_for(adapter.stderr, "odometry is left out")
    with SerialStandIn(tmp_path / "motors", MagniMotors(ticks=10), MOTORS):
        states = ros.ask("wait", topic="joint_states", count=before + 5)
    turned = [b["angles"][0] - a["angles"][0] for a, b in pairwise(states)]
    across_faults = [each for each in turned if each != pytest.approx(step)]
    assert len(across_faults) <= 1
    assert all(0.0 <= each <= LONGEST_GAP / 0.05 * step * 1.001 for each in across_faults)
