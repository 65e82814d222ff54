"""`ur env --graph`: the variables with which ROS 2 of this computer sees the nodes of a robot."""

import pytest

from ur.cli.computer.env import guest_changes
from ur.cli.main import main
from ur.robot.robot_file import Ros2Robot
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError

BOB = Selection("bob", "", ros="2")


def test_robot_is_asked_for_its_domain_and_middleware() -> None:
    robots = {"bob": Ros2Robot("jazzy", "7", "rmw_cyclonedds_cpp", "/bob")}
    assert guest_changes(BOB, "2", "jazzy", robots.__getitem__) == {
        "ROS_DOMAIN_ID": "7",
        "RMW_IMPLEMENTATION": "rmw_cyclonedds_cpp",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET",
        "ROS_STATIC_PEERS": "bob.local",
    }


def test_programs_of_zenoh_use_the_router_of_the_robot() -> None:
    found = guest_changes(BOB, "2", "jazzy", lambda _name: Ros2Robot("jazzy", "0", "rmw_zenoh_cpp"))
    assert found["ZENOH_CONFIG_OVERRIDE"] == 'mode="client";connect/endpoints=["tcp/bob.local:7447"]'
    assert "ROS_STATIC_PEERS" not in found


def test_middleware_of_the_release_is_left_alone() -> None:
    assert "RMW_IMPLEMENTATION" not in Ros2Robot("kilted").guest_variables("bob.local")


def test_option_is_refused_where_this_computer_uses_ros_1() -> None:
    with pytest.raises(UserError, match="--graph is for ROS 2, which this computer does not use"):
        guest_changes(BOB, "1", "")


@pytest.mark.parametrize(("own", "other"), [("kilted", "humble"), ("humble", "jazzy")])
def test_humble_does_not_join_nodes_of_newer_releases(own: str, other: str) -> None:
    with pytest.raises(UserError, match=f"{own.capitalize()}, and bob {other.capitalize()}: nodes of the two raise"):
        guest_changes(BOB, "2", own, lambda _name: Ros2Robot(other))
    assert guest_changes(BOB, "2", other, lambda _name: Ros2Robot(other))["ROS_DOMAIN_ID"] == "0"


def test_simulated_robot_is_in_the_graph_of_this_computer_anyway(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("UR_ROBOT", "sim")
    assert main(["env", "--graph"]) == 0
    assert "ROS_STATIC_PEERS" not in capsys.readouterr().out
