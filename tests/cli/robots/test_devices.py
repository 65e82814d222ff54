"""`ur devices` on this computer: rules for a base, and a list for programs."""

from __future__ import annotations

import json

import pytest

from ur.cli.main import main
from ur.cli.robots import devices
from ur.devices.model import Device, Snapshot

LIDAR = Device("/dev/ttyUSB0", "serial", "10c4:ea60", serial="0001", links=("/dev/rplidar",), group="dialout")


def run(*words: str) -> int:
    return main(["devices", *words])


@pytest.fixture
def plugged(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices, "inspect_devices", lambda _: Snapshot("pat", devices=(LIDAR,)))


def test_rules_of_a_base_are_printed_as_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--rules", "--base", "magni", "--variant", "lidar") == 0
    assert 'SYMLINK+="rplidar"' in capsys.readouterr().out


@pytest.mark.usefixtures("plugged")
def test_base_without_one_of_its_devices_is_reported(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--base", "magni", "--variant", "lidar") == 1
    out = capsys.readouterr().out
    assert "ok: /dev/rplidar: probably Slamtec RPLIDAR" in out
    assert "missing: the base needs /dev/ttyAMA0, which is not there" in out
    assert "missing: no camera is there, which the raspicam needs" in out


@pytest.mark.usefixtures("plugged")
def test_list_for_programs_names_device_and_stable_name(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--json") == 0
    (found,) = json.loads(capsys.readouterr().out)["devices"]
    assert (found["path"], found["stable"], found["usb"]) == ("/dev/ttyUSB0", "/dev/rplidar", "10c4:ea60")
