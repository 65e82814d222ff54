"""`ur devices` on this computer: rules for a base, and a list for programs."""

import json
from pathlib import Path

import pytest
from tests.devices.stand_ins.firmwares import RplidarA1
from tests.devices.stand_ins.serial_stand_in import SerialStandIn
from tests.devices.tree import Tree, TreeShell

from ur.cli.main import main
from ur.cli.robots import devices
from ur.devices.known import Device, DeviceSnapshot

LIDAR = Device("/dev/ttyUSB0", "serial", "10c4:ea60", serial="0001", links=("/dev/rplidar",), group="dialout")


def run(*words: str) -> int:
    return main(["devices", *words])


@pytest.fixture
def plugged(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(devices, "inspect_devices", lambda _: DeviceSnapshot("pat", devices=(LIDAR,)))


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


@pytest.fixture
def computer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Tree:
    """A computer whose devices are stand-ins, in place of this one."""
    tree = Tree(tmp_path)
    monkeypatch.setattr(devices, "LocalShell", lambda: TreeShell(tree))
    monkeypatch.setenv("COLUMNS", "300")
    return tree


def plug_lidar(computer: Tree, tty: str) -> SerialStandIn:
    """Plug an RPLIDAR in, with the name that our udev rules give it."""
    computer.plug("1-1.2", "10c4:ea60", serial="0001", tty=tty)
    (computer.root / "dev" / tty).unlink()
    computer.link("rplidar", tty)
    return SerialStandIn(computer.root / "dev" / tty, RplidarA1(), 115200)


def state_of_lidar(capsys: pytest.CaptureFixture[str]) -> str:
    """The state of the lidar that the base needs."""
    run("--json", "--base", "magni", "--variant", "lidar")
    found = json.loads(capsys.readouterr().out)
    return str(next(each for each in found["expected"] if each["path"] == "/dev/rplidar")["state"])


def test_unplugged_lidar_is_missing_and_ready_again_behind_another_device_file(
    computer: Tree, capsys: pytest.CaptureFixture[str]
) -> None:
    with plug_lidar(computer, "ttyUSB0"):
        assert state_of_lidar(capsys) == "ready"
    computer.unplug("1-1.2", "ttyUSB0")
    (computer.root / "dev/rplidar").unlink()
    assert state_of_lidar(capsys) == "missing"
    with plug_lidar(computer, "ttyUSB1"):
        assert state_of_lidar(capsys) == "ready"
        run()
        assert "/dev/ttyUSB1" in capsys.readouterr().out
