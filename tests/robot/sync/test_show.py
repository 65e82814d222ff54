"""A plan in words."""

from datetime import timezone

import pytest

from ur.robot.sync.compare import CLASH, compare, describe_file, describe_plan, describe_size, summarise
from ur.robot.sync.steps import Conflict, File, Manifest, SyncPlan, SyncStep

SECOND = 10**9
OLD = File("file", 1200, 1_700_000_000 * SECOND, False, "1")
NEW = File("file", 1310, 1_700_000_060 * SECOND, True, "2")


def lines(plan: SyncPlan) -> list[str]:
    return list(describe_plan(plan, "bob", zone=timezone.utc))


def test_steps_say_where_what_and_how_large() -> None:
    plan = compare(Manifest({"p/a": OLD}), Manifest({"p/b": NEW}), {})
    assert lines(plan) == ["  -> bob   new      p/a  (1.2 kB)", "  <- here  new      p/b  (1.3 kB)"]
    assert summarise(plan, "bob") == "1 change to bob, 1 change from bob"


def test_conflict_names_both_sides_and_what_to_do() -> None:
    plan = compare(Manifest({"p/a": OLD}), Manifest({"p/a": NEW}), {})
    said = "\n".join(lines(plan))
    assert "here: 1.2 kB, changed 2023-11-14 22:13:20" in said
    assert "bob: 1.3 kB, changed 2023-11-14 22:14:20, executable" in said
    assert "ur sync bob --take here p/a" in said
    assert summarise(plan, "bob") == "1 conflict"


def test_file_against_folder_cannot_be_taken() -> None:
    assert "move one of the two away" in lines(SyncPlan(conflicts=(Conflict("a", OLD, None, CLASH),)))[-1]


def test_many_steps_are_counted_by_folder() -> None:
    steps = tuple(SyncStep(f"p/{number}", "there", None, OLD) for number in range(100))
    (line,) = lines(SyncPlan(steps=steps))
    assert line.endswith("p: 100 files")


def test_nothing_to_do_is_said() -> None:
    assert summarise(SyncPlan(), "bob") == "in step with bob"


@pytest.mark.parametrize(
    ("size", "text"), [(0, "0 B"), (999, "999 B"), (1000, "1.0 kB"), (123_456, "123 kB"), (9_990_000_000, "10.0 GB")]
)
def test_sizes_are_short(size: int, text: str) -> None:
    assert describe_size(size) == text


def test_links_and_what_is_not_there_are_described() -> None:
    assert describe_file(None) == "not there"
    assert describe_file(File("link", 0, 0, False, "x")) == "a link to x"
