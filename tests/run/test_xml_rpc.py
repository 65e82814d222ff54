"""Our XML-RPC against the standard library's, which roslaunch uses."""

from __future__ import annotations

import socket
import xmlrpc.client
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.run.xml_rpc import MAXINT, Refused, Unanswered, call_method, dump_value, parse_response

_TEXT = st.text(st.characters(blacklist_categories=("Cs", "Cc")))
_VALUES: st.SearchStrategy[Any] = st.recursive(
    st.booleans()
    | st.integers(-MAXINT - 1, MAXINT)
    | st.floats(allow_nan=False, allow_infinity=False)
    | _TEXT
    | st.binary(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(_TEXT, inner, max_size=4),
    max_leaves=12,
)


def same(mine: Any, theirs: Any) -> bool:
    if isinstance(theirs, xmlrpc.client.Binary):
        theirs = theirs.data
    if isinstance(theirs, list):
        return len(mine) == len(theirs) and all(map(same, mine, theirs))
    if isinstance(theirs, dict):
        return mine.keys() == theirs.keys() and all(same(mine[key], theirs[key]) for key in mine)
    return type(mine) is type(theirs) and bool(mine == theirs)


@given(_VALUES)
def test_values_mean_the_same_to_the_standard_library(value: Any) -> None:
    text = f"<methodResponse><params><param>{dump_value(value)}</param></params></methodResponse>"
    (read,), _ = xmlrpc.client.loads(text)
    assert same(value, read)


@given(_VALUES)
def test_answers_of_the_standard_library_are_understood(value: Any) -> None:
    assert same(parse_response(xmlrpc.client.dumps((value,), methodresponse=True).encode()), value)


@pytest.mark.parametrize("value", [None, MAXINT + 1, {1, 2}, [None]])
def test_values_that_parameters_cannot_hold_are_refused(value: Any) -> None:
    with pytest.raises(ValueError, match=r"cannot hold|can hold"):
        dump_value(value)


def test_value_without_type_is_a_string() -> None:
    text = b"<methodResponse><params><param><value> a &amp; b</value></param></params></methodResponse>"
    assert parse_response(text) == " a & b"


def test_fault_is_refused_with_its_text() -> None:
    with pytest.raises(Refused, match="no such method"):
        parse_response(xmlrpc.client.dumps(xmlrpc.client.Fault(1, "no such method")).encode())


@pytest.mark.parametrize("text", [b"", b"<html>", b"not XML", b"<methodResponse/>"])
def test_other_answers_make_no_sense(text: bytes) -> None:
    with pytest.raises(Unanswered):
        parse_response(text)


def test_nobody_there_is_unanswered() -> None:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        with pytest.raises(Unanswered, match="connection refused"):
            call_method(probe.getsockname(), "getPid", [], 1.0)


def test_silence_is_unanswered_in_time() -> None:
    with socket.socket() as silent:
        silent.bind(("localhost", 0))
        silent.listen()
        with pytest.raises(Unanswered, match="did not answer within"):
            call_method(silent.getsockname(), "getPid", [], 0.05)
