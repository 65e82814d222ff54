"""The list of tests that passed on a second try, and the time after which it fails the build."""

from datetime import date

import pytest
from tools.second_tries import RECORD, add_tests, find_old, read_entries, write_lines

DAY = date(2026, 3, 15)
TEST = "tests/test_a.py::test_b"


def test_test_of_thirteen_days_ago_passes_and_of_fourteen_fails() -> None:
    assert find_old({TEST: date(2026, 3, 2)}, DAY) == []
    (line,) = find_old({TEST: date(2026, 3, 1)}, DAY)
    assert line.startswith(f"{TEST} passed only on a second try 14 days ago, on 2026-03-01; fix the test")
    assert line.endswith("remove its line from tests/second_tries.yaml")


def test_test_that_is_in_the_list_keeps_its_first_date() -> None:
    assert add_tests({TEST: date(2026, 3, 1)}, [TEST, "b"], DAY) == {TEST: date(2026, 3, 1), "b": DAY}


def test_lines_are_read_again_whatever_the_name_of_the_test() -> None:
    entries = {'tests/test_a.py::test_b[" \\ # : é]': DAY, TEST: DAY}
    assert read_entries("\n".join(write_lines(entries))) == entries


@pytest.mark.parametrize("text", ["- a", "a: yes", "a: 2026-03-15 10:00:00"])
def test_line_without_a_date_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="expected lines as"):
        read_entries(text)


def test_list_of_the_repository_can_be_read() -> None:
    read_entries(RECORD.read_text(encoding="utf-8"))
