"""Listing robots: who is there, what they say, who is away, and whose name is taken twice."""

from pathlib import Path

import pytest

from ur.robot.discovery.announcements import Announcement
from ur.robot.discovery.listing import RobotAnswer, RobotRow, is_settled, list_robots
from ur.robot.discovery.record import RobotRecord, find_user, load_records, render_record
from ur.robot.discovery.seen import SeenRobot

NOW = 1_000_000.0


def test_robots_that_are_there_come_before_those_that_are_away() -> None:
    rows = list_robots(
        [Announcement("zoe", "zoe", ("10.0.0.2",), "magni", version="1.0")],
        [RobotRecord("abe", "ros", "stage"), RobotRecord("zoe", "ros", "magni")],
        {"zoe": RobotAnswer(nodes=3)},
        {
            "abe": SeenRobot("abe", "10.0.0.7", NOW - 120.0),
            "ada": SeenRobot("ada", "10.0.0.8", NOW),
            "zoe": SeenRobot("zoe", "", 0.0),
        },
    )
    assert [(row.name, row.address, row.when(NOW)) for row in rows] == [
        ("zoe", "10.0.0.2", "here"),
        ("abe", "", "away, 2 min ago at 10.0.0.7"),
        ("ada", "", "away, just now at 10.0.0.8"),
    ]
    assert (rows[0].version, rows[0].answer.nodes, rows[1].base) == ("1.0", 3, "stage")
    assert RobotRow("x", "").when(NOW) == "away"


def test_robot_that_is_announced_and_does_not_answer_is_away() -> None:
    bob = Announcement("bob", "bob", ("10.0.0.2",), "magni")
    (row,) = list_robots([bob], [], {"bob": RobotAnswer(answers=False)})
    assert (row.name, row.address, row.base) == ("bob", "", "magni")
    assert list_robots([bob], [], {"bob": RobotAnswer(answers=True)})[0].address == "10.0.0.2"


def test_former_name_of_a_robot_is_not_listed() -> None:
    memory = {"robot": SeenRobot("robot", "10.0.0.2", NOW)}
    rows = list_robots([Announcement("bob", "bob", ("10.0.0.2",))], [], {}, memory)
    assert [row.name for row in rows] == ["bob"]


def test_two_robots_with_one_name_are_a_problem_of_both() -> None:
    rows = list_robots([Announcement("bob", "bob", ("10.0.0.2",)), Announcement("bob-2", "bob", ("10.0.0.3",))], [])
    assert [bool(row.problem) for row in rows] == [True, True]
    assert "bob-2.local" in rows[1].problem
    assert "bob-2.local" in rows[1].help


@pytest.mark.parametrize(("twin", "named"), [("10.0.0.9", True), ("", False), ("10.0.0.2", False)])
def test_computer_that_has_the_name_of_a_robot_and_is_none_is_named(twin: str, named: bool) -> None:
    (row,) = list_robots([Announcement("bob", "bob", ("10.0.0.2",))], [], {"bob": RobotAnswer(twin=twin)})
    assert bool(row.problem) is named
    assert ("10.0.0.9" in row.problem) is named


def test_what_runs_and_how_the_clock_is_are_said_when_they_are_known() -> None:
    answer = RobotAnswer(2, (("master", "active"), ("drive", "failed")), -0.0123)
    row = RobotRow("bob", "10.0.0.2", answer=answer)
    assert (row.runs, row.clock) == ("2 nodes, master, drive (failed)", "-0.012 s")
    assert (RobotRow("bob", "10.0.0.2").runs, RobotRow("bob", "10.0.0.2").clock) == ("", "")


@pytest.mark.parametrize(
    ("answer", "runs", "clock"),
    [
        (RobotAnswer(1, (("master", "active"),), 0.0), "1 node, master", "+0.000 s"),
        (RobotAnswer(0, (("master", "active"),), 0.0), "no nodes yet, master", "+0.000 s"),
        (RobotAnswer(None, (("master", "starting"),), 0.0), "no ROS master, master (starting)", "+0.000 s"),
        (RobotAnswer(3, refused="key refused"), "3 nodes", "unknown: key refused"),
    ],
)
def test_robot_that_is_starting_or_refuses_our_key_is_described(answer: RobotAnswer, runs: str, clock: str) -> None:
    row = RobotRow("bob", "10.0.0.2", answer=answer)
    assert (row.runs, row.clock) == (runs, clock)


@pytest.mark.parametrize(
    ("answer", "settled"),
    [
        (RobotAnswer(), False),
        (RobotAnswer(1, answers=True), False),  # no word over ssh yet
        (RobotAnswer(None, (("master", "active"),), 0.0), False),
        (RobotAnswer(0, (("master", "active"),), 0.0), False),
        (RobotAnswer(1, (("master", "active"),), 0.0), True),
        (RobotAnswer(None, (), 0.0), True),  # no master is started there at boot
        (RobotAnswer(None, refused="key refused"), True),
        (RobotAnswer(answers=False), True),
    ],
)
def test_robot_that_is_starting_is_waited_for(answer: RobotAnswer, settled: bool) -> None:
    assert is_settled(answer) is settled


def test_robot_that_announces_its_former_name_is_listed_by_the_present_one() -> None:
    (row,) = list_robots([Announcement("eve", "bob", ("10.0.0.2",))], [])
    assert row.name == "eve"
    assert "eve announces its former name, bob" in row.problem
    assert row.help == "ur robot setup eve.local --name eve"


@pytest.mark.parametrize(
    "answer", [RobotAnswer(), RobotAnswer(refused="host key unknown"), RobotAnswer(known_as="carol")]
)
def test_stranger_with_the_name_of_a_known_robot_is_not_proposed_for_a_set_up(answer: RobotAnswer) -> None:
    (row,) = list_robots(
        [Announcement("evil", "bob", ("10.0.0.66",))], [RobotRecord("bob", "ros", "magni")], {"evil": answer}
    )
    assert row.name == "evil"
    assert "has not shown the host key of bob" in row.problem
    assert "setup" not in row.help


@pytest.mark.parametrize("known_as", ["bob", "eve"])
def test_known_robot_by_another_name_is_proposed_for_a_set_up(known_as: str) -> None:
    sighting, record = Announcement("eve", "bob", ("10.0.0.2",)), RobotRecord("bob", "ros", "magni")
    (row, *_) = list_robots([sighting], [record], {"eve": RobotAnswer(known_as=known_as)})
    assert row.help == "ur robot setup eve.local --name eve"


def test_robot_that_another_computer_renamed_is_said_to_be_known_by_its_former_name() -> None:
    (row,) = list_robots([Announcement("eve", "eve", ("10.0.0.2",))], [], {"eve": RobotAnswer(known_as="bob")})
    assert row.problem == "eve was renamed: this computer knows it as bob"
    assert row.help == "ur robot rename bob eve"
    assert not list_robots([Announcement("eve", "eve", ("10.0.0.2",))], [], {"eve": RobotAnswer(known_as="eve")})[
        0
    ].problem


def test_records_are_read_back_and_broken_ones_left_out(tmp_path: Path) -> None:
    record = RobotRecord("bob", "pi", "magni", "lidar")
    (tmp_path / "bob.yaml").write_text(render_record(record))
    (tmp_path / "torn.yaml").write_text("name: [")
    assert load_records(tmp_path) == [record]
    assert find_user("bob", tmp_path) == "pi"
    assert find_user("nobody", tmp_path) == "ros"
