"""The memory of where robots were: kept, and never in the way."""

from pathlib import Path

import pytest

from ur.robot.discovery.seen import SeenRobot, describe_age, load_seen, note_seen, seen_path

BOB = SeenRobot("bob", "10.0.0.2", 100.0)


def test_robots_are_remembered_and_the_latest_place_counts(tmp_path: Path) -> None:
    path = tmp_path / "state" / "seen.json"
    note_seen(path, [BOB, SeenRobot("eve", "10.0.0.3", 50.0)])
    note_seen(path, [SeenRobot("bob", "10.0.0.9", 200.0), SeenRobot("zoe", "", 200.0)])
    assert load_seen(path) == {"bob": SeenRobot("bob", "10.0.0.9", 200.0), "eve": SeenRobot("eve", "10.0.0.3", 50.0)}
    assert [entry.name for entry in path.parent.iterdir()] == ["seen.json"]


@pytest.mark.parametrize("text", ["", "[", "{}", '[{"name": 1}]', "[1]", '"x"'])
def test_torn_memory_is_none(tmp_path: Path, text: str) -> None:
    path = tmp_path / "seen.json"
    path.write_text(text)
    assert load_seen(path) == {}
    note_seen(path, [BOB])
    assert load_seen(path) == {"bob": BOB}


def test_what_was_not_seen_for_months_is_forgotten(tmp_path: Path) -> None:
    path = tmp_path / "seen.json"
    note_seen(path, [BOB])
    late = SeenRobot("eve", "10.0.0.3", BOB.time + 100 * 86400.0)
    note_seen(path, [late])
    assert load_seen(path) == {"eve": late}


def test_folder_that_cannot_be_made_is_no_failure(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    note_seen(tmp_path / "file" / "seen.json", [BOB])


def test_place_follows_the_specification() -> None:
    assert seen_path({"XDG_STATE_HOME": "/x"}) == Path("/x/ubiquity_launches/seen.json")
    assert seen_path({"HOME": "/h", "XDG_STATE_HOME": "x"}) == Path("/h/.local/state/ubiquity_launches/seen.json")


@pytest.mark.parametrize(
    ("seconds", "words"), [(1.0, "just now"), (90.0, "2 min ago"), (7200.0, "2 h ago"), (200_000.0, "2 d ago")]
)
def test_age_is_said_in_words(seconds: float, words: str) -> None:
    assert describe_age(seconds) == words
