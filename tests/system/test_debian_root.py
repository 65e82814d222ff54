from pathlib import Path

import pytest

from ur.system.debian_root import DebianRoot, data_folder, describe_system, find_root, install_command
from ur.system.ros import Ros


@pytest.fixture
def mark(tmp_path: Path) -> str:
    path = tmp_path / "mark"
    path.touch()
    return str(path)


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({"HOME": "/home/pat"}, "/home/pat/.local/share/ubiquity_launches/debian-13"),
        ({"HOME": "/home/pat", "XDG_DATA_HOME": "/data"}, "/data/ubiquity_launches/debian-13"),
        ({"HOME": "/home/pat", "XDG_DATA_HOME": "relative"}, "/home/pat/.local/share/ubiquity_launches/debian-13"),
    ],
)
def test_data_folder_follows_the_base_directory_specification(environment: dict[str, str], expected: str) -> None:
    assert data_folder(environment) == expected


def test_no_root_is_found_outside(tmp_path: Path) -> None:
    assert find_root({"HOME": "/home/pat"}, mark=str(tmp_path / "absent")) is None


def test_root_is_found_inside_with_the_folder_of_its_programs(mark: str) -> None:
    root = find_root({"HOME": "/home/pat"}, mark=mark)
    assert root is not None
    assert root.programs == "/home/pat/.local/share/ubiquity_launches/debian-13/bin"


def test_packages_are_installed_by_apt_outside_and_by_ur_inside(mark: str, tmp_path: Path) -> None:
    assert install_command("gdb", mark=str(tmp_path / "absent")) == "sudo apt-get install gdb"
    assert install_command(["gdb", "rviz"], mark=mark) == "ur setup debian install gdb rviz"


def test_description_names_the_release_and_the_folder() -> None:
    assert describe_system(None) == "ROS: the packages of this computer"
    assert "Debian 13.1 in /data" in describe_system(DebianRoot("/data", "13.1"))
    wheels = Ros(2, "kilted", "/state/.ros2", "/state/.ros2/bin/python")
    assert (
        describe_system(None, wheels) == "ROS: ROS 2 Kilted, as wheels in /state/.ros2, supported until December 2026"
    )
