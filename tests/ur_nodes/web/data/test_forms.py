"""Fields of messages from JSON."""

import pytest

from ur_nodes.web.data.forms import BadValueError, make_template, read_fields, read_value
from ur_nodes.web.messages.definition import read_definition

NESTED = (
    """string name
uint8 count
bool good
float64 share
Inner inner
Inner[] many
float64[36] table
time at
"""
    + "=" * 80
    + """
MSG: a/Inner
float32 x
"""
)


def test_template_holds_every_field() -> None:
    template = make_template(read_definition("a/Outer", NESTED))
    assert template == {
        "name": "",
        "count": 0,
        "good": False,
        "share": 0.0,
        "inner": {"x": 0.0},
        "many": [],
        "table": [],
        "at": {"secs": 0, "nsecs": 0},
    }
    assert isinstance(template["share"], float)
    assert isinstance(template["count"], int)


def test_template_is_not_deeper_than_a_form() -> None:
    assert make_template(read_definition("a/Outer", NESTED), 1)["inner"] == ""


@pytest.mark.parametrize("text", ["NaN", "[Infinity]", "1e999", "{", "[" * 100_000])
def test_value_that_is_not_finite_json_is_refused(text: str) -> None:
    with pytest.raises(BadValueError, match="value: "):
        read_value(text)


def test_fields_are_an_object() -> None:
    assert read_fields("") == {}
    assert read_fields('{"x": 1}') == {"x": 1}
    with pytest.raises(BadValueError, match="JSON object"):
        read_fields("[1]")
