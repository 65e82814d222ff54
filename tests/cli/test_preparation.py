from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from ur.cli.preparation import prepare
from ur.launchfile.plan.load import load_plan
from ur.launchfile.plan.model import Plan
from ur.launchfile.world.system import SystemWorld
from ur.source.diagnostic import UserError

LIBRARY = Path(__file__).parents[2] / "ubiquity_launches"
LAUNCH = LIBRARY / "m_move_base" / "launch" / "m_move_base.launch.xml"


class Installer:
    """Keeps what was asked for."""

    def __init__(self) -> None:
        self.asked: list[tuple[tuple[str, ...], str, str]] = []

    def __call__(self, modules: Sequence[str], lock: str, title: str) -> None:
        self.asked.append((tuple(modules), lock, title))


def load(path: Path, *arguments: str) -> tuple[Plan, SystemWorld]:
    world = SystemWorld({"ROS_PACKAGE_PATH": f"{LIBRARY}:/usr/share", "HOME": "/home/nobody"})
    return load_plan([str(path)], ["robot_base:=magni", "map_file:=/map.yaml", *arguments], world), world


def test_vision_is_installed_before_what_needs_it_starts(tmp_path: Path) -> None:
    (tmp_path / "map.txt").write_text("")
    installer = Installer()
    prepare(*load(LAUNCH, "localisation:=fiducials", f"fiducial_map:={tmp_path / 'map.txt'}"), installer)
    ((modules, lock, title),) = installer.asked
    assert set(modules) == {"cv2", "gtsam"}
    assert lock == "vision.lock"
    assert "OpenCV and gtsam" in title
    assert (LIBRARY.parent / "requirements" / lock).is_file()


def test_nothing_is_installed_for_what_does_without() -> None:
    installer = Installer()
    prepare(*load(LAUNCH), installer)
    assert installer.asked == []


def test_missing_map_of_fiducials_is_told_with_the_program_that_builds_it() -> None:
    with pytest.raises(
        UserError, match=r"/fiducial_slam: /none.txt is not there, expected a map of fiducials"
    ) as caught:
        prepare(*load(LAUNCH, "localisation:=fiducials", "fiducial_map:=/none.txt"), Installer())
    assert "ur run fiducial_slam" in str(caught.value.diagnostics[0].help)


def test_map_that_is_about_to_be_built_may_be_missing() -> None:
    path = LIBRARY / "n_fiducial_slam" / "launch" / "n_fiducial_slam.launch.xml"
    world = SystemWorld({"ROS_PACKAGE_PATH": f"{LIBRARY}:/usr/share", "HOME": "/home/nobody"})
    prepare(load_plan([str(path)], ["map_file:=/none.txt"], world), world, Installer())


def test_programs_of_upstream_and_of_other_computers_need_nothing_of_ours() -> None:
    path = LIBRARY / "n_fiducial_slam" / "launch" / "n_fiducial_slam.launch.xml"
    world = SystemWorld({"ROS_PACKAGE_PATH": f"{LIBRARY}:/usr/share", "HOME": "/home/nobody"})
    installer = Installer()
    for argument in ("fiducial_slam_pkg:=fiducial_slam", "machine:=elsewhere"):
        prepare(load_plan([str(path)], ["read_only_map:=true", argument], world), world, installer)
    assert installer.asked == []
