"""The lines about several robots."""

import pytest

from ur.fleet.jobs import JobStatus, choose_line, describe_end, describe_fleet, summarise

FLEET = (
    JobStatus("bob", "done", 10.0, 13.2, "all is well", 0),
    JobStatus("eve", "done", 10.0, 20.0, "error: no answer", 2),
    JobStatus("kit", "running", 10.0, 0.0, "50 %"),
    JobStatus("zoe"),
)


def test_each_robot_has_one_line_and_columns_are_aligned() -> None:
    assert describe_fleet(FLEET, 31.0) == [
        "bob  ok             3 s  all is well",
        "eve  failed (2)    10 s  error: no answer",
        "kit  running       21 s  50 %",
        "zoe  waiting",
    ]


def test_summary_counts_and_names_those_that_failed_or_were_interrupted() -> None:
    assert summarise(FLEET[:2]) == "1 of 2 robots ok; failed: eve"
    assert summarise((FLEET[0], JobStatus("kit", "done", 1.0, 2.0, code=130))) == "1 of 2 robots ok; interrupted: kit"
    assert summarise(FLEET[:1]) == "1 of 1 robot ok"
    assert describe_end(FLEET[1]) == "eve: failed (2) after 10 s: error: no answer"


def test_foreign_output_does_not_act_on_the_terminal() -> None:
    (line,) = describe_fleet((JobStatus("bob", "running", 0.0, 0.0, "a\x1b]0;title\x07b"),), 1.0)
    assert "\x1b" not in line
    assert "\\x1b]0;title" in line


@pytest.mark.parametrize(
    ("lines", "code", "chosen"),
    [
        (["begun", "50 %", ""], None, "50 %"),
        (["error: no answer", "  help: is it on?"], 2, "error: no answer"),
        (["a", "b", "c", "d", "make: failed"], 2, "make: failed"),
        (["error: no answer", "done"], 0, "done"),
        ([], 1, ""),
    ],
)
def test_line_that_stands_for_an_output(lines: list[str], code: int | None, chosen: str) -> None:
    assert choose_line(lines, code) == chosen
