"""Speeds in the parameter files around a description."""

import dataclasses
from pathlib import Path

import pytest

from ur.robot.description.speed_files import FoundSpeeds, find_speeds
from ur.robot.description.surroundings import find_surroundings

CONTROLLER = """
my_controller:
  type: diff_drive_controller/DiffDriveController
  linear: {x: {max_velocity: 2.0, max_acceleration: 1.5, min_acceleration: -3.0}}
  angular: {z: {max_velocity: 4.0}}
"""
CONTROLLER_2 = """
/**:
  base_controller:
    ros__parameters: {linear.x.max_velocity: 0.46, linear.x.max_acceleration: 0.9, angular.z.max_velocity: 1.9}
"""
SMOOTHER = "velocity_smoother: {ros__parameters: {max_velocity: [0.5, 0.0, 2.5], max_decel: [-2.5, 0.0, -3.2]}}"
PLANNER = "DWAPlannerROS: {max_vel_x: 0.22, max_vel_theta: 1.0, acc_lim_x: 2.5, decel_lim_x: -2.5}"


def find(folder: Path, robot: str = "robot.urdf", **files: str) -> FoundSpeeds | None:
    """The speeds of a repository with these files, whose names have `__` for a slash."""
    (folder / ".git").mkdir(parents=True, exist_ok=True)
    for name, text in {**files, f"urdf__{robot.replace('.urdf', '')}": "<robot/>"}.items():
        path = folder / (name.replace("__", "/") + (".urdf" if text == "<robot/>" else ".yaml"))
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return find_speeds(find_surroundings(folder / "urdf" / robot, {"HOME": "/nonexistent"}))


@pytest.mark.parametrize(
    ("text", "speeds"),
    [
        (CONTROLLER, FoundSpeeds("my_controller of config/it.yaml", 2.0, 4.0, 1.5, 3.0)),
        (CONTROLLER_2, FoundSpeeds("base_controller of config/it.yaml", 0.46, 1.9, 0.9)),
        (SMOOTHER, FoundSpeeds("velocity_smoother of config/it.yaml", 0.5, 2.5, None, 2.5)),
        (PLANNER, FoundSpeeds("DWAPlannerROS of config/it.yaml", 0.22, 1.0, 2.5, 2.5)),
    ],
)
def test_speeds_are_read_in_each_of_their_forms(tmp_path: Path, text: str, speeds: FoundSpeeds) -> None:
    found = find(tmp_path, config__it=text)
    assert found is not None
    assert dataclasses.replace(found, navigation=None) == speeds
    assert found.navigation == (speeds if text in (SMOOTHER, PLANNER) else None)


def test_installed_description_has_the_speeds_of_the_packages_of_its_robot(tmp_path: Path) -> None:
    for name, velocity in (("rover_control", 2.0), ("rover_description", 0.0), ("tractor_control", 0.7)):
        (tmp_path / name / "config").mkdir(parents=True)
        (tmp_path / name / "package.xml").write_text("<package/>", encoding="utf-8")
        (tmp_path / name / "config/control.yaml").write_text(f"{{max_vel_x: {velocity}}}", encoding="utf-8")
    description = tmp_path / "rover_description/rover.urdf"
    description.write_text("<robot/>", encoding="utf-8")
    found = find_speeds(find_surroundings(description, {"HOME": "/nonexistent"}))
    assert found is not None
    assert (found.velocity, found.source) == (2.0, "planner of ../rover_control/config/control.yaml")


def test_controller_comes_before_navigation_and_the_slower_of_two(tmp_path: Path) -> None:
    found = find(tmp_path, nav__a=PLANNER, nav__b=SMOOTHER, control__c=CONTROLLER)
    assert found is not None
    assert found.velocity == 2.0
    assert found.navigation is not None
    assert found.navigation.velocity == 0.22
    assert find(tmp_path / "nav", nav__a=PLANNER, nav__b=SMOOTHER) == find(tmp_path / "other", nav__a=PLANNER)


def test_file_that_is_named_after_the_robot_comes_first(tmp_path: Path) -> None:
    slower = PLANNER.replace("0.22", "0.1")
    found = find(tmp_path, "turtle_waffle.urdf", param__burger=slower, param__waffle=PLANNER)
    assert found is not None
    assert found.source == "DWAPlannerROS of param/waffle.yaml"


def test_controller_comes_before_navigation_that_is_named_after_the_robot(tmp_path: Path) -> None:
    found = find(tmp_path, "burger.urdf", param__burger=PLANNER, control__diff_drive=CONTROLLER_2)
    assert found is not None
    assert (found.velocity, found.navigation and found.navigation.velocity) == (0.46, 0.22)


@pytest.mark.parametrize(
    "text",
    ["a: [", "max_vel_x: fast", "max_vel_x: true", "max_vel_x: .inf", "max_vel_x: .nan", "linear: {x: [1]}", "- 1"],
)
def test_file_that_says_no_speed_is_passed_over(tmp_path: Path, text: str) -> None:
    assert find(tmp_path, config__it=text) is None


def test_nothing_outside_of_the_repository_or_hidden_in_it_is_read(tmp_path: Path) -> None:
    (tmp_path / "outside.yaml").write_text(PLANNER)
    inside = tmp_path / "repository"
    find(inside)
    (inside / "link.yaml").symlink_to(tmp_path / "outside.yaml")
    (inside / ".hidden").mkdir()
    (inside / ".hidden" / "it.yaml").write_text(PLANNER)
    assert find(inside) is None
