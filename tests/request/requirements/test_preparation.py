from collections.abc import Sequence
from pathlib import Path

import pytest

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.protocol import PackageNotFound
from ur.launchfile.world.system import SystemWorld
from ur.request.requirements.preparation import name_missing, prepare
from ur.source.diagnostic import UserError, error

LIBRARY = Path(__file__).parents[3] / "ubiquity_launches"
LAUNCH = LIBRARY / "m_move_base" / "launch" / "m_move_base.launch.xml"


class Installer:
    """Keeps what was asked for."""

    def __init__(self) -> None:
        self.asked: list[tuple[tuple[str, ...], str, str]] = []

    def __call__(self, modules: Sequence[str], lock: str, title: str) -> None:
        self.asked.append((tuple(modules), lock, title))


class DebianInstaller:
    """Keeps which Debian packages were asked for, and whether sudo may ask; it fails where it `refuses`."""

    def __init__(self, *, refuses: bool = False) -> None:
        self.asked: list[tuple[tuple[str, ...], ...]] = []
        self.may_ask: list[bool] = []
        self._refuses = refuses

    def __call__(self, alternatives: Sequence[Sequence[str]], title: str, *, ask: bool = True) -> None:
        self.asked.append(tuple(map(tuple, alternatives)))
        self.may_ask.append(ask)
        if self._refuses:
            raise UserError(error(f"{title} could not be installed", rule="no-package"))


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


OPENGL = (("libegl1", "libopengl0", "libgl1-mesa-dri"), ("libosmesa6",))


@pytest.mark.parametrize(
    ("program", "wanted"),
    [
        ("m_raspicam_view", [OPENGL]),
        ("m_raspicam", [OPENGL]),
        ("m_fiducial_slam", [OPENGL]),
        ("m_keyboard_drive", []),
        ("m_keyboard_navigate", []),
    ],
)
def test_programs_that_use_the_simulated_camera_get_opengl(
    program: str, wanted: list[tuple[tuple[str, ...], ...]]
) -> None:
    packages = DebianInstaller()
    plan, world = load_program(program)
    assert not prepare(plan, world, Installer(), packages)
    assert packages.asked == wanted


def test_real_camera_needs_no_opengl() -> None:
    packages = DebianInstaller()
    prepare(*load_program("m_raspicam_view", "simulate:=false"), Installer(), packages)
    assert packages.asked == []


class WorldWithoutRviz(SystemWorld):
    """This computer, had nobody installed RViz on it."""

    def find_package(self, name: str) -> str:
        """See World."""
        if name == "rviz":
            raise PackageNotFound(name)
        return super().find_package(name)


def test_rviz_is_installed_where_there_is_a_display() -> None:
    for environment, wanted in (({"DISPLAY": ":0"}, [(("rviz",),)]), ({}, [])):
        packages = DebianInstaller()
        plan, world = load_program("rviz_robot")
        without = WorldWithoutRviz({**world.environment, **environment})
        assert prepare(plan, without, Installer(), packages) is bool(wanted)
        assert packages.asked == wanted


def test_program_starts_without_rviz_that_cannot_be_installed_and_a_view_does_not() -> None:
    plan, world = load_program("rviz_robot")
    without = WorldWithoutRviz({**world.environment, "DISPLAY": ":0"})
    packages = DebianInstaller(refuses=True)
    assert not prepare(plan, without, Installer(), packages)
    with pytest.raises(UserError, match="RViz"):
        prepare(plan, without, Installer(), packages, view=True)
    assert packages.may_ask == [False, True]


def load_program(name: str, *arguments: str) -> tuple[Plan, SystemWorld]:
    world = SystemWorld({"ROS_PACKAGE_PATH": f"{LIBRARY}:/usr/share", "HOME": "/home/nobody"})
    path = LIBRARY / name / "launch" / f"{name}.launch.xml"
    return load_plan([str(path)], ["robot_base:=magni", *arguments], world), world


def test_missing_messages_of_nav2_are_named_where_nav2_drives(tmp_path: Path) -> None:
    path = LIBRARY / "m_keyboard_navigate" / "launch" / "m_keyboard_navigate.launch.xml"
    (line,) = name_missing(*load(path, "navigation:=nav2"))
    assert line.startswith("warning: /keyboard_navigate: package 'nav2_msgs' is not installed: no goal can be sent")
    assert "  help: Nav2 needs ROS 2" in line
    assert name_missing(*load(path)) == []
    (tmp_path / "nav2_msgs").mkdir()
    (tmp_path / "nav2_msgs" / "package.xml").write_text("<package>\n  <name>nav2_msgs</name>\n</package>\n")
    installed = SystemWorld({"ROS_PACKAGE_PATH": f"{LIBRARY}:{tmp_path}", "HOME": "/home/user"})
    plan = load_plan([str(path)], ["robot_base:=magni", "navigation:=nav2"], installed)
    assert name_missing(plan, installed) == []
