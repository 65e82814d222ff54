"""Our XML-RPC against the standard library's, which roslaunch uses."""

import itertools
import socket
import threading
import xmlrpc.client
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.run.master.xml_rpc import MAXINT, CallRefused, Unanswered, call_method, dump_value, parse_response

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
    with pytest.raises(CallRefused, match="no such method"):
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


HEAD = b"HTTP/1.0 200 OK\r\n"
VALUE = b"<value><array><data>"
START = b"<methodResponse><params><param>"
BOMB = (
    b"<!DOCTYPE a [<!ENTITY a 'aaaaaaaaaa'><!ENTITY b '&a;&a;&a;&a;&a;&a;&a;&a;'>]>"
    b"<methodResponse><params><param><value>&b;</value></param></params></methodResponse>"
)


@contextmanager
def server(parts: Iterable[bytes], *, pause: float = 0.0) -> Iterator[tuple[str, int]]:
    """A server that answers its first caller with these parts, one after the other, until the caller has gone."""
    over = threading.Event()

    def serve() -> None:
        link, _ = listener.accept()
        with link, suppress(OSError):
            for part in parts:
                link.sendall(part)
                if over.wait(pause):
                    return

    with socket.create_server(("localhost", 0)) as listener:
        thread = threading.Thread(target=serve)
        thread.start()
        try:
            yield listener.getsockname()
        finally:
            over.set()
            thread.join()


@pytest.mark.parametrize("start", [b"", HEAD + b"\r\n", HEAD + b"Content-Length: 100000\r\n\r\n"])
def test_answer_that_drips_costs_its_timeout(start: bytes) -> None:
    # With a deadline for each byte only, this takes for ever: the server goes on as long as somebody reads.
    with (
        server(itertools.chain([start], itertools.repeat(b"x")), pause=0.01) as address,
        pytest.raises(Unanswered, match="did not answer within"),
    ):
        call_method(address, "getPid", [], 0.3)


@pytest.mark.parametrize(
    ("start", "says"),
    [
        (b"", "without the end of a head"),
        (HEAD + b"\r\n", "larger than"),
        (HEAD + b"X: y", "without the end of a head"),
    ],
)
def test_answer_without_end_is_cut_off(start: bytes, says: str) -> None:
    with (
        server(itertools.chain([start], itertools.repeat(b"x" * 65536))) as address,
        pytest.raises(Unanswered, match=says),
    ):
        call_method(address, "getPid", [], 60.0)


@pytest.mark.parametrize("length", [b"99999999999", b"many", b"-5", b"1e9"])
def test_length_that_is_none_is_no_exception(length: bytes) -> None:
    with server([HEAD + b"Content-Length: " + length + b"\r\n\r\n"]) as address, pytest.raises(Unanswered):
        call_method(address, "getPid", [], 10.0)


@pytest.mark.parametrize(
    "text",
    [
        BOMB,
        START + VALUE * 200,
        b"<methodResponse><fault>" + VALUE * 5000,
        START + VALUE + b"<value/>" * 600_000,
        START + b"<value><struct><member><value/><value><array><data/></array></value>",
    ],
)
def test_answer_that_would_fill_the_memory_is_refused(text: bytes) -> None:
    with pytest.raises(Unanswered):
        parse_response(text)


def test_name_that_is_none_is_unanswered() -> None:
    with pytest.raises(Unanswered, match="not the name of a computer"):
        call_method(("a" * 70 + ".local", 11311), "getPid", [], 1.0)


def test_time_for_reading_an_answer_counts() -> None:
    clock = iter(range(1000))
    text = "<methodResponse><params><param><value><array><data>" + "<value/>" * 450_000
    text += "</data></array></value></param></params></methodResponse>"
    with pytest.raises(TimeoutError):
        parse_response(text.encode(), 5.0, lambda: float(next(clock)))
    assert next(clock) < 10  # it has not read the rest
    found = parse_response(text.encode())
    assert isinstance(found, list)
    assert len(found) == 450_000
