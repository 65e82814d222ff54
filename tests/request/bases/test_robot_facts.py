"""Who says what base the selected robot is."""

import socket

import pytest

from ur.request.bases.robot_facts import Facts, know_base, read_facts
from ur.robot.robot_file import RobotFile
from ur.robot.selection import Selection

HERE = socket.gethostname().split(".")[0]
FILE = RobotFile("bob", "loki", "")


def know(
    selection: Selection, facts: Facts | None = None, environment: dict[str, str] | None = None
) -> tuple[Selection, list[str]]:
    asked: list[str] = []

    def ask(uri: str) -> Facts | None:
        asked.append(uri)
        return facts

    return know_base(selection, environment or {}, ask=ask, robot_file=lambda: FILE), asked


def test_robot_that_runs_knows_best() -> None:
    known, asked = know(Selection("sim", "stage"), ("magni", "lidar"))
    assert known == Selection("sim", "magni", "lidar")
    assert asked == ["http://localhost:11311"]


def test_simulated_robot_is_what_was_selected_where_none_runs() -> None:
    assert know(Selection("sim", "magni", "lidar"))[0] == Selection("sim", "magni", "lidar")


def test_master_that_a_person_has_set_is_asked() -> None:
    assert know(Selection(), None, {"ROS_MASTER_URI": "http://bob.local:11311"})[1] == ["http://bob.local:11311"]


def test_master_of_an_earlier_selection_is_not_asked() -> None:
    environment = {"ROS_MASTER_URI": "http://bob.local:11311", "UR_SELECTION": "bob"}
    assert know(Selection(), None, environment)[1] == ["http://localhost:11311"]


def test_base_that_was_selected_with_a_robot_stays_and_nobody_is_asked() -> None:
    assert know(Selection("bob", "magni"), ("loki", "")) == (Selection("bob", "magni"), [])


def test_robot_without_a_base_is_asked_over_the_network() -> None:
    known, asked = know(Selection("bob", ""), ("loki", ""))
    assert known == Selection("bob", "loki")
    assert asked == ["http://bob.local:11311"]


def test_file_of_this_computer_tells_where_it_is_the_robot_and_no_master_runs() -> None:
    assert know(Selection(HERE, ""))[0] == Selection(HERE, "loki")
    assert know(Selection("bob-is-away", ""))[0] == Selection("bob-is-away", "")


@pytest.mark.parametrize("uri", ["http://localhost:1", "nonsense", ""])
def test_nobody_there_means_nothing_is_known(uri: str) -> None:
    assert read_facts(uri) is None
