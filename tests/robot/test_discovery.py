"""Listing robots: who is there, who is away, and whose name is taken twice."""

from __future__ import annotations

from pathlib import Path

from ur.robot.discovery import Row, Sighting, list_robots, parse_sighting
from ur.robot.record import Record, find_user, load_records, render_record


def test_robots_that_are_there_come_before_those_that_are_away() -> None:
    rows = list_robots(
        [Sighting("zoe", "zoe", ("10.0.0.2",), "magni")], [Record("abe", "ros", "stage"), Record("zoe", "ros", "magni")]
    )
    assert rows == [Row("zoe", ("10.0.0.2",), "magni", ""), Row("abe", (), "stage", "")]


def test_two_computers_with_one_name_are_a_problem_of_both() -> None:
    rows = list_robots([Sighting("bob", "bob", ("10.0.0.2",)), Sighting("bob-2", "bob", ("10.0.0.3",))], [])
    assert [bool(row.problem) for row in rows] == [True, True]
    assert "bob-2.local" in rows[1].problem
    assert "bob-2.local" in rows[1].help


def test_announcement_without_a_name_is_known_by_its_host_name() -> None:
    assert parse_sighting("bob-2.local.", ["10.0.0.3"], {}) == Sighting("bob-2", "bob", ("10.0.0.3",))
    assert parse_sighting("r2-d2.local.", [], {"name": "r2-d2"}).name == "r2-d2"


def test_records_are_read_back_and_broken_ones_left_out(tmp_path: Path) -> None:
    record = Record("bob", "pi", "magni", "lidar")
    (tmp_path / "bob.yaml").write_text(render_record(record))
    (tmp_path / "torn.yaml").write_text("name: [")
    assert load_records(tmp_path) == [record]
    assert find_user("bob", tmp_path) == "pi"
    assert find_user("nobody", tmp_path) == "ros"
