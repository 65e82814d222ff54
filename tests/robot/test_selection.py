from pathlib import Path

import pytest

from ur.robot.robot_file import RobotFile, load_robot_file
from ur.robot.selection import Selection, load_selection, parse_selection, selection_path, store_selection
from ur.source import UserError


@pytest.mark.parametrize(
    ("text", "selection", "written"),
    [
        ("sim", Selection("sim", "stage", ""), "sim:stage"),
        ("sim:magni:lidar\n", Selection("sim", "magni", "lidar"), "sim:magni:lidar"),
        ("robbie", Selection("robbie", "", ""), "robbie"),
        ("robbie.local:loki", Selection("robbie", "loki", ""), "robbie:loki"),
        ("sim:magni --ros 2\n", Selection("sim", "magni", "", "2"), "sim:magni --ros 2"),
    ],
)
def test_selection_is_read_and_written(text: str, selection: Selection, written: str) -> None:
    assert parse_selection(text) == selection
    assert str(selection) == written
    assert parse_selection(written) == selection


@pytest.mark.parametrize("text", ["", ":", "-x", "a.b.c", "robbie::lidar", "sim:a:b:c", "sim:a/b", "sim --ros 3"])
def test_bad_selection_names_the_form(text: str) -> None:
    with pytest.raises(UserError, match="expected sim"):
        parse_selection(text)


def test_relative_configuration_folder_is_ignored() -> None:
    path = selection_path({"XDG_CONFIG_HOME": "relative", "HOME": "/home/me"})
    assert path == Path("/home/me/.config/ubiquity_launches/selection")


def test_stored_selection_comes_back(tmp_path: Path) -> None:
    path = tmp_path / "deep/selection"
    assert load_selection(path) == Selection()
    store_selection(path, Selection("robbie", "magni", "lidar"))
    assert load_selection(path) == Selection("robbie", "magni", "lidar")
    assert [each.name for each in path.parent.iterdir()] == ["selection"]


def test_place_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match="file/selection: cannot be written"):
        store_selection(tmp_path / "file/selection", Selection())


def test_robot_file_is_read(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    assert load_robot_file(path) is None
    path.write_text("name: robbie\nbase: magni\ndevices: {motor: /dev/ttyAMA0}\n")
    assert load_robot_file(path) == RobotFile("robbie", "magni", "")
    path.write_text("name: robbie\nbsae: magni\n")
    with pytest.raises(UserError):
        load_robot_file(path)
