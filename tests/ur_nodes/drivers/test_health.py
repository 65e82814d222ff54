"""What drivers report of their devices, as `ur doctor` reads it."""

import os
import random
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from msgspec.structs import replace as replace_fields
from tests.robot.doctor.pairs import ROBOT
from tests.ur_nodes.drivers.rig import one_of
from tests.ur_nodes.drivers.test_base_driver import make_rig

from ur.devices.driver_health import OBSERVE_DRIVERS, DriverHealth, health_file, parse_drivers, write_health
from ur.robot.base.own_drivers import NO_WATCHDOG
from ur.robot.doctor.rules import diagnose_alone
from ur.robot.doctor.rules.drivers import describe_driver
from ur.source.foreign.json_values import write_json
from ur_nodes.drivers.health import PERIOD, HealthMeter, report_to_file
from ur_nodes.drivers.registry import BOARDS
from ur_nodes.memory.bus import Bus


def last(reports: list[DriverHealth]) -> DriverHealth:
    return reports[-1]


@pytest.mark.parametrize("name", one_of(BOARDS, "magni"))
def test_board_is_reported_with_firmware_frames_and_battery(name: str) -> None:
    reports: list[DriverHealth] = []
    rig = make_rig(name, reports.append)
    rig.drive(0.1, 0.0, 11.0)
    health = last(reports)
    assert (health.device, health.kind, health.open) == ("/dev/test", BOARDS[name](rig.base).name, True)
    assert health.firmware
    assert health.frames > 4.0
    assert health.damaged < 0.2
    if name != "loki":  # its board does not measure the battery
        assert health.voltage == pytest.approx(16.4, abs=0.3)
    assert (health.problem, health.held, health.empty) == ("", "", False)


@pytest.mark.parametrize("name", one_of(BOARDS, "magni"))
def test_noise_is_counted_and_an_unplugged_board_is_reported_with_the_reason(name: str) -> None:
    reports: list[DriverHealth] = []
    rig = make_rig(name, reports.append)
    rig.drive(0.0, 0.0, 1.0)
    rig.cable.random, rig.cable.noise, rig.cable.cut = random.Random(1), 0.01, 0.3
    rig.drive(0.1, 0.0, 10.5)
    assert max(each.damaged for each in reports) > 0.5
    rig.cable.plugged = False
    rig.drive(0.0, 0.0, 5.5)
    assert (last(reports).open, last(reports).reason, last(reports).frames) == (False, "it was unplugged", 0.0)


def test_emergency_stop_and_an_old_firmware_are_reported() -> None:
    reports: list[DriverHealth] = []
    rig = make_rig("magni", reports.append)
    rig.firmware.power, rig.firmware._version = False, 20
    rig.cable.plugged = False
    rig.drive(0.0, 0.0, 0.5)
    rig.cable.plugged = True
    rig.drive(0.1, 0.0, 6.0)
    assert last(reports).held == "its motors have no power (emergency stop?)"
    assert last(reports).problem.startswith("firmware 20, expected 35")


def test_doctor_reads_the_files_of_drivers_that_run(tmp_path: Path) -> None:
    health = DriverHealth("/dev/create", "iRobot Create 2", open=True, firmware="streams", frames=66.4, voltage=16.42)
    environment = {**os.environ, "XDG_RUNTIME_DIR": str(tmp_path), "HOME": str(tmp_path)}
    path = health_file("/robot/base_driver", environment)
    assert write_health(path, health) == ""
    assert path.name == "robot.base_driver.json"
    old = health_file("/lidar_driver", environment)
    write_health(old, health)
    os.utime(old, (0, 0))
    health_file("/bad", environment).write_text("{")
    done = subprocess.run(["sh", "-c", OBSERVE_DRIVERS], env=environment, capture_output=True, text=True, check=True)
    assert parse_drivers(done.stdout) == (health,)
    assert describe_driver(health) == "/dev/create: iRobot Create 2, streams, 66 frames/s, 0.0 damaged, 16.4 V"
    assert describe_driver(replace_fields(health, drives_on=True)).endswith(f"16.4 V, {NO_WATCHDOG}")
    side = replace(ROBOT, observed={"drivers": done.stdout})
    assert [each.rule for each in diagnose_alone(side)] == [each.rule for each in diagnose_alone(ROBOT)]


@pytest.mark.parametrize(
    "record",
    ['{"device": "/dev/x"}', '{"device": 3, "kind": "x"}', "[]", "", "null", '{"device": "' + "x" * 5000 + '"}'],
)
def test_records_that_make_no_sense_are_left_out(record: str) -> None:
    good = write_json(DriverHealth("/dev/x", "x"))
    assert parse_drivers(f"1 {record}\n{'9' * 30} {good}\nx {good}\n2 {good}") == (DriverHealth("/dev/x", "x"),)


def test_file_is_removed_at_the_end_and_a_folder_that_cannot_be_written_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    bus = Bus()
    node = bus.node("base_driver")
    report = report_to_file(node)
    report(DriverHealth("/dev/x", "x"))
    bus.run(0.1)
    path = health_file("/base_driver")
    assert path.exists()
    node.end("the test ends it")
    assert not path.exists()
    (tmp_path / "file").write_text("")
    assert write_health(tmp_path / "file" / "y.json", DriverHealth("", ""))


def test_driver_whose_health_file_cannot_be_written_says_so_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / "file"))
    bus = Bus()
    node = bus.node("base_driver")
    report = report_to_file(node)
    for _ in range(3):
        report(DriverHealth("/dev/x", "x"))
        bus.run(0.1)
    path = health_file("/base_driver")
    (line,) = [text for _, text in node.lines]
    assert line == f"{path} cannot be written (Not a directory); ur doctor does not see this driver"


class StoppedNode:
    """A node whose time passes only when the test says so."""

    def __init__(self) -> None:
        self.time = 0.0
        self.beats: list[Callable[[], None]] = []

    def steady(self) -> float:
        return self.time

    def every(self, seconds: float, call: Callable[[], None], *, steady: bool) -> None:
        assert (seconds, steady) == (PERIOD, True)
        self.beats.append(call)


def test_two_reports_at_the_same_time_have_the_rates_of_the_seconds_before() -> None:
    node, reports = StoppedNode(), list[DriverHealth]()
    meter = HealthMeter(node, "/dev/x", "x", reports.append)  # type: ignore[arg-type]
    (beat,) = node.beats
    meter.count(50, 5)
    node.time = 5.0
    beat()
    meter.count(3, 3)
    beat()
    assert [(each.frames, each.damaged) for each in reports] == [(10.0, 1.0)] * 2
