import os
from pathlib import Path

import pytest

from ur.robot.base import load_base
from ur.source.diagnostic import UserError
from ur.source.project import launch_library
from ur_nodes.simulator.devices.bench import DeviceTerminal, list_own_drivers


def test_terminal_has_the_name_of_the_device_and_carries_every_byte(tmp_path: Path) -> None:
    terminal = DeviceTerminal(tmp_path / "devices" / "create")
    driver = os.open(terminal.path, os.O_RDWR | os.O_NOCTTY)
    every = bytes(range(256))
    os.write(driver, every)
    terminal.write(every)
    assert (terminal.read(), os.read(driver, 1000)) == (every, every)
    os.close(driver)
    terminal.close()
    assert not terminal.path.is_symlink()


def test_name_that_a_killed_simulator_has_left_is_taken(tmp_path: Path) -> None:
    (tmp_path / "create").symlink_to("/dev/pts/nowhere")
    DeviceTerminal(tmp_path / "create").close()


def test_device_of_another_simulator_is_left_to_it(tmp_path: Path) -> None:
    terminal = DeviceTerminal(tmp_path / "create")
    with pytest.raises(UserError, match="a device of another simulator"):
        DeviceTerminal(tmp_path / "create")
    assert terminal.path.is_symlink()
    terminal.close()
    DeviceTerminal(tmp_path / "create").close()


def test_folder_that_is_no_folder_of_this_user_is_refused(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path)
    with pytest.raises(UserError, match=r"link is another user's"):
        DeviceTerminal(tmp_path / "link" / "create")
    (tmp_path / "file").write_text("")
    with pytest.raises(UserError, match="cannot be made"):
        DeviceTerminal(tmp_path / "file" / "create")


def test_base_without_a_driver_of_ours_has_no_devices() -> None:
    with pytest.raises(UserError, match="no driver of this project"):
        list_own_drivers(load_base(launch_library(), "stage", ""))
    assert list_own_drivers(load_base(launch_library(), "create2", "lidar")) == {
        "/dev/create": "create2",
        "/dev/rplidar": "rplidar",
    }
