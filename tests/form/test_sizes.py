"""Sizes in src: functions up to 60 lines, modules up to 500; test_exceptions.py has the least size of a module."""

from collections.abc import Mapping

from tests.form.facts import Facts

MOST_LINES = 500
MOST_LINES_OF_A_FUNCTION = 60


def test_functions_have_at_most_60_lines(modules: Mapping[str, Facts]) -> None:
    functions = [(path, each) for path, facts in modules.items() for each in facts.functions]
    assert [(path, each.name, each.lines) for path, each in functions if each.lines > MOST_LINES_OF_A_FUNCTION] == []


def test_modules_have_at_most_500_lines(modules: Mapping[str, Facts]) -> None:
    assert {path: each.lines for path, each in modules.items() if each.lines > MOST_LINES} == {}
