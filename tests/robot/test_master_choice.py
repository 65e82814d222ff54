"""The robot that a ROS_MASTER_URI set by hand means."""

import pytest

from ur.robot.master_choice import follow_master
from ur.robot.selection import Selection
from ur.source.diagnostic import UserError

BOB = Selection("bob", "magni", "lidar")


def follow(uri: str, selection: Selection = BOB, hostname: str = "laptop") -> Selection:
    return follow_master(selection, uri, hostname, lambda host: "10.0.0.7" if host == "bob.local" else "")


@pytest.mark.parametrize("uri", ["http://localhost:11411", "http://127.0.0.1:11311/", "http://laptop.local:11311"])
def test_master_on_this_computer_means_a_simulated_robot_of_the_selected_base(uri: str) -> None:
    assert follow(uri) == Selection("sim", "magni", "lidar")
    assert follow(uri, Selection("bob", "")) == Selection("sim", "stage")


@pytest.mark.parametrize(
    "uri", ["http://bob.local:11311", "http://bob.local:11311/", "http://bob:11311", "http://10.0.0.7:11311"]
)
def test_every_name_of_the_selected_robot_keeps_the_selection(uri: str) -> None:
    assert follow(uri) == BOB


def test_master_on_the_robot_itself_keeps_its_driver() -> None:
    assert follow("http://localhost:11311", hostname="bob.lan") == BOB


def test_master_on_another_host_means_the_robot_of_that_name() -> None:
    assert follow("http://alice.local:11311") == Selection("alice", "")


def test_simulated_selection_stays_with_any_master() -> None:
    assert follow("http://10.0.0.9:11311", Selection()) == Selection()


@pytest.mark.parametrize("uri", ["http://10.0.0.9:11311", "http://a.b.c:11311", "nonsense", "http://[x"])
def test_master_that_names_no_robot_is_refused_with_the_way_back(uri: str) -> None:
    with pytest.raises(UserError, match="is not the master of bob") as caught:
        follow(uri)
    assert caught.value.diagnostics[0].help == "unset ROS_MASTER_URI, and select with 'ur use ROBOT'"
