"""Fields of messages from JSON."""

from __future__ import annotations

import pytest

from ur_nodes.web.data.forms import BadValueError, make_template, read_fields, read_value


class Inner:
    __slots__ = ("x",)
    _slot_types = ("float64",)


class Outer:
    __slots__ = ("at", "count", "good", "inner", "many", "name")
    _slot_types = ("time", "uint8", "bool", "a/Inner", "a/Inner[]", "string")


def test_template_holds_every_field() -> None:
    assert make_template(Outer, lambda kind: Inner if kind == "a/Inner" else None) == {
        "name": "",
        "count": 0,
        "good": False,
        "inner": {"x": 0.0},
        "many": [],
        "at": {"secs": 0, "nsecs": 0},
    }


def test_type_that_holds_itself_ends() -> None:
    class Loop:
        __slots__ = ("again",)
        _slot_types = ("a/Loop",)

    assert make_template(Loop, lambda _: Loop)["again"]


@pytest.mark.parametrize("text", ["NaN", "[Infinity]", "1e999", "{", "[" * 100_000])
def test_value_that_is_not_finite_json_is_refused(text: str) -> None:
    with pytest.raises(BadValueError, match="value: "):
        read_value(text)


def test_fields_are_an_object() -> None:
    assert read_fields("") == {}
    assert read_fields('{"x": 1}') == {"x": 1}
    with pytest.raises(BadValueError, match="JSON object"):
        read_fields("[1]")
