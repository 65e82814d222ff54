"""Parameter files: which text stays as it is, and which is written anew or refused."""

import math

import pytest
import yaml

from ur.tools.convert.parameter_files import convert_parameters

HEAD = "/**:\n  ros__parameters:\n"


def read(text: str, substitutes: bool = False) -> dict[str, object]:
    return dict(yaml.safe_load(convert_parameters(text, substitutes))["/**"]["ros__parameters"])


@pytest.mark.parametrize(
    "text",
    ["a: {b: {c: 1}}\nl: [1, 2] # two\n", "flags: [true, false]\n\nrates: [1.5]\n", "# a robot\nname: 'it'\n"],
)
def test_text_that_means_the_same_stays_below_the_head(text: str) -> None:
    lines = [f"    {line}".rstrip() for line in text.splitlines()]
    assert convert_parameters(text, False) == HEAD + "\n".join(lines) + "\n"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("a: |\n  x\n  y\n", {"a": "x\ny\n"}),
        ("a: x # 50%\n", {"a": "x"}),
        ("a: !degrees 180\n", {"a": math.pi}),
        ("a: rad(2)\nb: {c: [d]}\n", {"a": 2.0, "b": {"c": ["d"]}}),
        ("l: [1, 2.5]\n", {"l": [1.0, 2.5]}),
        ("l: [1, a]\n", {"l": ["1", "a"]}),
        ("l: [[1], [2]]\n", {"l": "[[1], [2]]"}),
        (
            "a: deg(0)\nfar: .inf\nnear: -.inf\nl: [1.5, .inf]\n",
            {"a": 0, "far": math.inf, "near": -math.inf, "l": [1.5, math.inf]},
        ),
    ],
)
def test_text_that_would_mean_something_else_is_written_anew(text: str, values: dict[str, object]) -> None:
    assert read(text) == values


def test_value_that_is_no_number_stays_a_number_of_yaml() -> None:
    value = read("a: rad(1)\nunknown: .nan\n")["unknown"]
    assert isinstance(value, float)
    assert math.isnan(value)


@pytest.mark.parametrize("text", ["{}\n", "a: null\n", "l: []\n"])
def test_file_without_values_sets_no_parameters(text: str) -> None:
    assert convert_parameters(text, False) == "/**:\n  ros__parameters: {}\n"


def test_substitutions_are_written_as_ros2_has_them_where_they_are_read() -> None:
    text = "a: $(arg who)\nb: $(find  demo)/x\nc: $(optenv HOME)\n"
    assert read(text, substitutes=True) == {"a": "$(var who)", "b": "$(find-pkg-share demo)/x", "c": "$(env HOME)"}
    assert read(text) == {"a": "$(arg who)", "b": "$(find  demo)/x", "c": "$(optenv HOME)"}


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("- 1\n", "expected names with values"),
        ("", "expected names with values"),
        ("a: [\n", "expected the node content"),
        ("a: 1\n---\nb: 2\n", "expected a single document"),
    ],
)
def test_file_that_holds_no_parameters_is_refused(text: str, reason: str) -> None:
    with pytest.raises(ValueError, match=reason):
        convert_parameters(text, False)
