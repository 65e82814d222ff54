"""Every rule's own examples, checked: a bad one gives exactly that finding at the marked place, a good one none."""

import re

import pytest

from ur.check.catalogue import load_rules
from ur.check.render.pages import FOLDER, check_example
from ur.check.rule import Example, Rule
from ur.source.render import render_human

RULES = load_rules()
WITHOUT_EXAMPLE = {  # limits of size, and what depends on the computer
    "attribute-too-long", "broken-package", "file-too-large", "include-too-deep", "nested-too-deep",
    "too-many-includes", "too-many-params", "unreadable-file", "unset-variable", "value-too-long",
}  # fmt: skip
BAD = [(rule, example) for rule in RULES.values() for example in rule.bad]
GOOD = [(rule, example) for rule in RULES.values() for example in rule.good]


def marked_place(example: Example) -> tuple[str, int, int]:
    path, text = next(each for each in example.files.items() if "«" in each[1])
    return path if path.startswith("/") else f"{FOLDER}/{path}", text.index("«"), text.index("»") - 1


def name_of(value: object) -> str:
    return value.id if isinstance(value, Rule) else ""


@pytest.mark.parametrize(("rule", "example"), BAD, ids=name_of)
def test_bad_example_gives_exactly_its_finding_at_the_marked_place(rule: Rule, example: Example) -> None:
    report = check_example(example)
    shown = render_human(report.findings)
    assert [found.rule for found in report.findings] == [rule.id], shown
    span = report.findings[0].span
    assert span is not None
    assert (span.file.path, span.start, span.end) == marked_place(example), shown
    assert report.findings[0].severity is rule.severity
    assert report.findings[0].subject


@pytest.mark.parametrize(("rule", "example"), GOOD, ids=name_of)
def test_good_example_gives_no_finding(rule: Rule, example: Example) -> None:
    assert render_human(check_example(example).findings) == "", rule.id


def test_every_rule_has_examples_unless_named_here() -> None:
    assert {rule.id for rule in RULES.values() if not rule.bad} == WITHOUT_EXAMPLE
    assert {rule.id for rule in RULES.values() if not rule.good} == WITHOUT_EXAMPLE


@pytest.mark.parametrize("rule", RULES.values(), ids=name_of)
def test_rule_is_written_as_the_others(rule: Rule) -> None:
    assert re.fullmatch(r"[a-z]+(-[a-z]+)+", rule.id)
    assert rule.summary.endswith(".")
    assert "\n" not in rule.summary
    assert rule.explanation.strip()


def test_findings_of_examples_say_what_to_do_where_the_message_does_not() -> None:
    without = {rule.id for rule, example in BAD for found in check_example(example).findings if not found.help}
    assert without <= {
        "bad-eval", "bad-number", "bad-param-type", "bad-remap", "bad-yaml", "deprecated-file", "empty-attribute",
        "include-cycle", "param-conflict", "rosparam-file",
    }  # fmt: skip
