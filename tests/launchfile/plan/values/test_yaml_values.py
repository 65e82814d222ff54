import math
import random
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from ur.launchfile.plan.values.yaml_values import YamlProblem, read_yaml

WORDS = (
    "a|b|c: |key:|:|: |- |-|[|]|{|}|, |,|\n|\n  |\n    | |1|2.5|true|no|1e3|.inf|.|..|x/y|deg(90)|rad(pi)|(|)|+1|-5|0x1"
)
TOKENS = [*WORDS.split("|"), "1:2", "1_0", "010"]
LONGEST = 16


def _slow(text: str) -> Any:
    try:
        value = yaml.load(text, Loader=yaml.SafeLoader)  # PyYAML's own parser, as in roslaunch
    except (yaml.YAMLError, ValueError, TypeError):
        return "refused"
    return value


def _agree(text: str) -> None:
    try:
        fast = read_yaml(text, reads_angles=False).value
    except YamlProblem:
        fast = "refused"
    assert repr(fast) == repr(_slow(text)), repr(text)


@settings(max_examples=500)
@given(st.lists(st.sampled_from(TOKENS), max_size=LONGEST).map("".join))
def test_fast_parser_reads_the_same_texts_each_time_as_the_slow_one(text: str) -> None:
    _agree(text)


@pytest.mark.parametrize("examples", [20_000, pytest.param(50_000, marks=pytest.mark.nightly)])
def test_fast_parser_reads_what_the_slow_one_reads(examples: int) -> None:
    for _ in range(examples):  # hypothesis takes five times as long to make a text as both parsers to read it
        _agree("".join(random.choices(TOKENS, k=random.randint(0, LONGEST))))


def test_angles_are_numbers_once_asked_for() -> None:
    text = "a: deg(180)\nb: rad(2*pi)\nc: !degrees 90\nd: deg(-45.5)\n"
    value = read_yaml(text, reads_angles=True).value
    assert isinstance(value, dict)
    assert value == {"a": math.pi, "b": 2 * math.pi, "c": math.pi / 2, "d": -45.5 * math.pi / 180}
    assert read_yaml("a: deg(180)", reads_angles=False).value == {"a": "deg(180)"}


@pytest.mark.parametrize("text", ["a:\n  b: 1\n", "a:\n  'b': 1\n", "# é\na:\n  b: 1\n"])
def test_place_of_a_key_is_where_it_is_written(text: str) -> None:
    start, end = read_yaml(text, reads_angles=True).place_of(("a", "b"))
    assert text[start:end].strip("'") == "b"


def test_problem_says_where() -> None:
    with pytest.raises(YamlProblem) as caught:
        read_yaml("a: 1\nb: [1\nc: 2\n", reads_angles=True)
    assert caught.value.offset == len("a: 1\nb: [1\nc")
    assert caught.value.help == "close the '[' that line 2 of the YAML opens"
