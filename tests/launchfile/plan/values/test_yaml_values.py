import math
from typing import Any

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from ur.launchfile.plan.values.yaml_values import YamlProblem, read_yaml

WORDS = (
    "a|b|c: |key:|:|: |- |-|[|]|{|}|, |,|\n|\n  |\n    | |1|2.5|true|no|1e3|.inf|.|..|x/y|deg(90)|rad(pi)|(|)|+1|-5|0x1"
)
TOKENS = st.lists(st.sampled_from([*WORDS.split("|"), "1:2", "1_0", "010"]), max_size=16).map("".join)


def _slow(text: str) -> Any:
    try:
        value = yaml.load(text, Loader=yaml.SafeLoader)  # PyYAML's own parser, as in roslaunch
    except (yaml.YAMLError, ValueError, TypeError):
        return "refused"
    return value


@pytest.mark.parametrize(
    "examples",
    [
        500,
        20_000,
        pytest.param(50_000, marks=pytest.mark.nightly),
    ],
)
def test_fast_parser_reads_what_the_slow_one_reads(examples: int) -> None:
    @settings(max_examples=examples, deadline=None, derandomize=examples <= 500, database=None)
    @given(TOKENS)
    def agree(text: str) -> None:
        try:
            fast = read_yaml(text, reads_angles=False).value
        except YamlProblem:
            fast = "refused"
        assert repr(fast) == repr(_slow(text))

    agree()


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
