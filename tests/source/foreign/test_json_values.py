"""JSON of other people as values: the limits of a type hold, and a refusal says what was expected."""

import gc
import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import Meta

from ur.source.foreign.json_values import (
    BadJsonError,
    Count,
    ForeignValue,
    PrintableValue,
    Timestamp,
    convert_json,
    describe_type,
    read_json,
    write_json,
)


class Move(PrintableValue, frozen=True, tag_field="t", tag="move", rename={"distance": "d"}):
    distance: Annotated[float, Meta(ge=-2.0, le=2.0)]
    name: Annotated[str, Meta(max_length=5)] = ""
    tags: tuple[str, ...] = ()


class Wait(ForeignValue, frozen=True, tag_field="t", tag="wait"):
    count: Count
    mode: Literal["idle", "busy"] = "idle"


@dataclass(frozen=True, slots=True)
class Entry:
    name: str
    started: Timestamp = 0.0


REQUEST = Move | Wait


def refusal(text: object, kind: Any = REQUEST, longest: int = 500) -> str:
    with pytest.raises(BadJsonError) as found:
        read_json(text, kind, longest)
    return str(found.value)


def test_values_are_read_and_written() -> None:
    assert read_json('{"t": "move", "d": 1, "name": "a"}', REQUEST) == Move(1.0, "a")
    assert read_json(b'{"t": "wait", "count": 3}', REQUEST) == Wait(3)
    assert read_json(write_json(Move(0.5, "b", ("c",))), REQUEST) == Move(0.5, "b", ("c",))
    assert convert_json({"count": 3, "t": "wait"}, Wait) == Wait(3)


def test_bytes_of_a_name_that_are_no_text_are_replaced_when_it_is_written() -> None:
    assert read_json(write_json(Entry("a\udcff")), Entry) == Entry("a?")


def test_dataclasses_are_read_without_fields_of_a_later_version() -> None:
    assert read_json('{"name": "a", "started": 5, "later": [1]}', Entry) == Entry("a", 5.0)
    assert refusal('{"name": "a", "started": -1}', Entry) == "started: expected seconds since 1970"


@pytest.mark.parametrize(
    ("value", "reason"),
    [
        ({}, "t: expected one of move, wait"),
        ({"t": ["move"]}, "t: expected one of move, wait"),
        ({"t": "move"}, "d: expected a number from -2 to 2"),
        ({"t": "move", "d": 3}, "d: expected a number from -2 to 2"),
        ({"t": "move", "d": True}, "d: expected a number from -2 to 2"),
        ({"t": "move", "d": 1, "name": "longer"}, "name: expected text of at most 5"),
        ({"t": "move", "d": 1, "name": "a\nb"}, "name: expected text of at most 5"),
        ({"t": "move", "d": 1, "tags": ["\x1b[2J"]}, "tags: expected a list"),
        ({"t": "move", "d": 1, "distance": 1}, "'distance': expected one of t, d, name, tags"),
        ({"t": "wait", "count": -1}, "count: expected a whole number below 2^32"),
        ({"t": "wait", "count": 1.0}, "count: expected a whole number below 2^32"),
        ({"t": "wait", "count": 1, "mode": 3}, "mode: expected one of idle, busy"),
        ([], "expected a JSON object"),
    ],
)
def test_refusal_names_the_field_and_what_was_expected(value: object, reason: str) -> None:
    assert refusal(json.dumps(value)) == reason


@pytest.mark.parametrize(
    "text", ["", "{", "NaN", '{"t": "move", "d": 1e999}', "[" * 400, '"\ud800"', b"\xff", '{"d": "\\ud800"}']
)
def test_what_is_not_json_is_refused(text: object) -> None:
    assert refusal(text) == "expected JSON"


def test_long_texts_and_other_types_are_refused_before_they_are_parsed() -> None:
    for text in (" " * 501, None, 5, ["{}"]):
        assert refusal(text) == "expected a text of at most 500 characters"


@pytest.mark.parametrize("depth", [900, 100_000])
def test_deep_values_are_read_or_refused(depth: int) -> None:
    for text in ("[" * depth + "]" * depth, '{"t": "wait", "count": 1, "x": ' + "[" * depth):
        with suppress(BadJsonError):
            read_json(text, Any, 1 << 20)
        with pytest.raises(BadJsonError):
            read_json(text, REQUEST, 1 << 20)


def test_types_are_described_by_their_limits() -> None:
    assert describe_type(bool) == "true or false"
    assert describe_type(Annotated[int, Meta(ge=1, le=5)] | None) == "a whole number from 1 to 5"
    assert describe_type(Annotated[tuple[str, ...], Meta(max_length=3)]) == "a list of at most 3"


VALUES = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.sampled_from(["t", "d", "name", "count", "tags"]), inner),
)


@pytest.fixture(scope="module")
def small_heap() -> Iterator[None]:
    """Have gc.collect() look at new objects only: a process of the whole suite has millions of others."""
    gc.freeze()
    yield
    gc.unfreeze()


@pytest.mark.usefixtures("small_heap")
@given(VALUES, st.sampled_from(["move", "wait", "x"]))
def test_any_json_is_read_or_refused_in_a_line(value: object, kind: str) -> None:
    for each in (value, {**value, "t": kind} if isinstance(value, dict) else value):
        assert "\n" not in refusal_or_nothing(json.dumps(each))
    gc.collect()


def refusal_or_nothing(text: str) -> str:
    try:
        read_json(text, REQUEST)
    except BadJsonError as problem:
        return str(problem)
    return ""
