import os
import subprocess
from pathlib import Path

import pytest

from ur.request.environment import (
    current_selection,
    environment_changes,
    hide_ros2,
    render_exports,
    watch_selection,
)
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError

PACKAGE = Path("/place/ubiquity_launches")
ROBOT = Selection("robbie", "", "")


def changes(selection: Selection, **environment: str) -> dict[str, str]:
    own = {"XDG_CONFIG_HOME": "/nowhere"} | environment  # a user's workspaces
    return environment_changes(selection, own, package=PACKAGE, hostname="laptop")


def test_simulation_is_on_this_computer() -> None:
    assert changes(Selection(), PATH="/bin") == {
        "ROS_PACKAGE_PATH": "/place/ubiquity_launches:/usr/share",
        "PATH": "/place/ubiquity_launches/bin:/bin",
        "UR_SELECTION": "sim:stage",
        "ROS_MASTER_URI": "http://localhost:11311",
        "ROS_HOSTNAME": "localhost",
    }


def test_robot_is_reached_by_name_and_reaches_us_by_name() -> None:
    found = changes(ROBOT, PATH="/bin")
    assert found["ROS_MASTER_URI"] == "http://robbie.local:11311"
    assert found["ROS_HOSTNAME"] == "laptop.local"


def test_applying_twice_changes_nothing() -> None:
    once = changes(ROBOT, PATH="/bin", ROS_PACKAGE_PATH="/mine:/usr/share")
    assert changes(ROBOT, **once) == once
    assert once["ROS_PACKAGE_PATH"] == "/place/ubiquity_launches:/mine:/usr/share"


def test_simulated_robot_on_humble_stays_on_this_computer() -> None:
    shell = {"ROS_VERSION": "2", "ROS_DISTRO": "humble", "AMENT_PREFIX_PATH": "/opt/ros/humble"}
    assert changes(Selection("sim", "", "", "2"), **shell)["ROS_LOCALHOST_ONLY"] == "1"
    on_robot = {**shell, "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    assert "ROS_LOCALHOST_ONLY" not in changes(Selection("sim", "", "", "2"), **on_robot)
    assert "ROS_LOCALHOST_ONLY" not in changes(Selection("sim", "", "", "2"), **shell | {"ROS_DISTRO": "jazzy"})


def test_new_selection_replaces_the_old_one() -> None:
    before = changes(ROBOT, PATH="/bin")
    assert changes(Selection(), **before) == changes(Selection(), PATH="/bin")


def test_what_a_person_has_set_stays() -> None:
    mine = {"ROS_MASTER_URI": "http://other:11311", "ROS_HOSTNAME": "me", "PATH": "/bin"}
    found = {**mine, **changes(ROBOT, **mine)}
    assert found["ROS_MASTER_URI"] == "http://other:11311"
    assert found["ROS_HOSTNAME"] == "me"
    assert "ROS_HOSTNAME" not in changes(ROBOT, ROS_IP="10.0.0.2")


@pytest.mark.parametrize("value", ["plain", "with space", "it's", '$HOME "`x`'])
def test_exports_survive_the_shell(value: str) -> None:
    script = render_exports({"NAME": value}) + 'printf %s "$NAME"'
    done = subprocess.run(["bash", "-c", script], capture_output=True, text=True, check=True, env=dict(os.environ))
    assert done.stdout == value


def test_ros_2_of_the_shell_is_hidden_from_programs_and_nothing_else() -> None:
    shell = {
        "AMENT_PREFIX_PATH": "/home/ada/ws/install/p:/opt/ros/humble",
        "PYTHONPATH": "/opt/ros/humble/lib/python3.10/site-packages:/home/ada/lib:/opt/ros/humbler",
        "LD_LIBRARY_PATH": "/opt/ros/humble/lib",
        "CMAKE_PREFIX_PATH": "/home/ada/ws/install/p:/home/ada/rover",
        "ROS_DISTRO": "humble",
        "ROS_VERSION": "2",
    }
    assert hide_ros2(shell) == {
        "PYTHONPATH": "/home/ada/lib:/opt/ros/humbler",
        "LD_LIBRARY_PATH": "",
        "CMAKE_PREFIX_PATH": "/home/ada/rover",
        "ROS_DISTRO": "Debian",
        "ROS_VERSION": "1",
    }


def test_shell_without_ros_2_keeps_its_search_paths() -> None:
    assert hide_ros2({"PYTHONPATH": "/opt/ros/noetic/lib:/home/ada/lib", "ROS_VERSION": "1"}) == {}


def test_environment_that_names_a_robot_precedes_the_stored_selection(tmp_path: Path) -> None:
    folder = tmp_path / ".config/ubiquity_launches"
    folder.mkdir(parents=True)
    (folder / "selection").write_text("alice\n")
    home = {"HOME": str(tmp_path)}
    assert current_selection(home) == Selection("alice", "")
    assert current_selection(home | {"UR_ROBOT": "bob:magni"}) == Selection("bob", "magni")
    assert current_selection(home | {"UR_ROBOT": ""}) == Selection("alice", "")
    with pytest.raises(UserError):
        current_selection(home | {"UR_ROBOT": "--bob"})


def test_selection_that_leads_to_other_nodes_is_found_while_it_is_selected(tmp_path: Path) -> None:
    stored = tmp_path / ".config/ubiquity_launches/selection"
    stored.parent.mkdir(parents=True)
    home = {"HOME": str(tmp_path), "PATH": "/bin"}
    find = watch_selection(home | environment_changes(Selection(ros="1"), home))
    for text, moved in (("sim:stage", ""), ("sim:magni", ""), ("sim --ros none", "sim:stage --ros none"), ("--", "")):
        stored.write_text(f"{text}\n")
        assert find() == moved, text
