import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.tui.fake import line

from ur.run.clients.protocol import Notice
from ur.source.ansi import strip_styles
from ur.tui.journal import MOST_AT_ONCE, MOST_ENTRIES, MOST_LINES, Filter, Journal, clean, strip_head


def journal(*texts: str, name: str = "/a") -> Journal:
    made = Journal()
    made.add([line(name, text) for text in texts], 1.0)
    return made


def lines(made: Journal) -> list[list[str]]:
    return [entry.lines for entry in made.entries]


@pytest.mark.parametrize(("text", "bare"), [
    ("[ INFO] [1700000000.100000000]: hello", "hello"),
    ("[INFO] [1700000000.1, 12.5]: hello", "hello"),
    ("[INFO] [WallTime: 1700000000.1] [12.5] hello", "[12.5] hello"),
    ("[ERROR] hello", "hello"),
    ("plain [INFO] hello", "plain [INFO] hello"),
])  # fmt: skip
def test_head_of_a_message_is_left_out(text: str, bare: str) -> None:
    assert strip_head(text) == bare


def test_coloured_message_of_several_lines_stays_together() -> None:
    made = Journal()
    told = ["\x1b[31m[ERROR] [1700000000.1]: first", "second", "third\x1b[0m", "another"]
    mixed = [line("/a", told[0]), line("/b", "between"), *(line("/a", text) for text in told[1:])]
    made.add(mixed, 1.0)
    assert lines(made) == [["first", "second", "third"], ["between"], ["another"]]
    assert made.entries[0].severity == "error"
    assert made.entries[2].severity == ""


def test_traceback_is_one_error() -> None:
    made = journal("before", "Traceback (most recent call last):", '  File "x"', "    f()", "ValueError: no", "after")
    assert lines(made)[1] == ["Traceback (most recent call last):", '  File "x"', "    f()", "ValueError: no"]
    assert [entry.severity for entry in made.entries] == ["", "error", ""]


def test_indented_lines_belong_to_the_message_above() -> None:
    made = journal("[WARN] [1.0]: bad things:", "  one", "  two", "print")
    assert lines(made) == [["bad things:", "  one", "  two"], ["print"]]


def test_equal_messages_are_counted_whatever_their_stamps() -> None:
    made = journal("[WARN] [1.0]: low", "[WARN] [2.0]: low", "[WARN] [3.0]: low", "[ERROR] [4.0]: low")
    assert [(entry.severity, entry.count) for entry in made.entries] == [("warning", 3), ("error", 1)]


def test_flood_is_counted_and_what_is_kept_has_a_bound() -> None:
    made = Journal()
    for start in range(0, 60_000, 1000):
        made.add([line("/a", f"number {number}") for number in range(start, start + 1000)], 1.0)
    assert len(made.entries) <= MOST_ENTRIES
    assert made.entries[-1].flood == 1000 - MOST_AT_ONCE
    assert "800 more lines" in made.entries[-1].lines[0]


def test_message_without_end_has_a_bound() -> None:
    made = journal("\x1b[31m[ERROR] [1.0]: begins", *(f"line {number}" for number in range(MOST_AT_ONCE - 1)))
    made.add([line("/a", f"more {number}") for number in range(MOST_AT_ONCE)], 1.0)
    assert len(made.entries) == 1
    assert len(made.entries[0].lines) == MOST_LINES


def test_notice_of_several_lines_is_one_entry() -> None:
    made = Journal()
    made.add([Notice("error", "/a died\n  log: x")], 1.0)
    assert lines(made) == [["/a died", "  log: x"]]


def test_changes_name_the_oldest_entry_that_changed() -> None:
    made = journal("one", "two")
    assert made.pop_changes() == 0
    assert made.pop_changes() is None
    made.add([line("/a", "two")], 2.0)
    assert made.pop_changes() == 1


@pytest.mark.parametrize(("filter_", "shown"), [
    (Filter(), ["one", "two", "three"]),
    (Filter(node="/a"), ["one"]),
    (Filter(rank=2), ["two"]),
    (Filter(text="THRE"), ["three"]),
    (Filter(muted=frozenset({"/b"})), ["one", "three"]),
    (Filter(text="/b"), ["two"]),
])  # fmt: skip
def test_filter_admits(filter_: Filter, shown: list[str]) -> None:
    made = Journal()
    made.add([line("/a", "one"), line("/b", "[WARN] [1.0]: two"), line("/c", "\x1b[1mthr\x1b[0mee")], 1.0)
    assert [strip_styles(entry.lines[0]) for entry in made.entries if filter_.admits(entry)] == shown


@given(st.text())
def test_clean_leaves_nothing_that_moves_a_terminal(text: str) -> None:
    assert strip_styles(clean(text)).isprintable() or strip_styles(clean(text)) == ""


@given(st.lists(st.tuples(st.sampled_from(["/a", "/b"]), st.text(max_size=20)), max_size=60))
def test_journal_takes_whatever_nodes_print(printed: list[tuple[str, str]]) -> None:
    made = Journal()
    made.add([line(name, text) for name, text in printed], 1.0)
    numbers = [entry.number for entry in made.entries]
    assert numbers == sorted(set(numbers))
    assert sum(len(entry.lines) * entry.count for entry in made.entries) >= len(made.entries)
