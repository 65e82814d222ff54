"""Lease and requests as JSON: everything from outside is checked."""

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.lease.text import (
    FREE,
    LONGEST_NAME,
    Lease,
    LeaseRequest,
    Viewer,
    clean_name,
    read_lease,
    read_request,
    write_lease,
    write_request,
)

REQUEST = LeaseRequest("a1", "laptop", "keyboard_drive", "take", False, (1_234_567, 89))
LEASE = Lease("held", "a1", "laptop", "p", 1.8e9, False, (Viewer("b", "desktop"),), Viewer("c", "phone"), 1.8e9)


def change(text: str, **fields: Any) -> str:
    return json.dumps({**json.loads(text), **fields})


@pytest.mark.parametrize("lease", [FREE, LEASE, Lease("lost", "a1", "laptop")])
def test_lease_survives_the_journey(lease: Lease) -> None:
    assert read_lease(write_lease(lease)) == lease


def test_request_survives_the_journey() -> None:
    assert read_request(write_request(REQUEST)) == REQUEST


@pytest.mark.parametrize(
    ("fields", "problem"),
    [
        ({"client": ""}, "client: expected an id"),
        ({"client": "a b"}, "client: expected an id"),
        ({"client": "a" * 65}, "client: expected an id"),
        ({"client": 3}, "client: expected an id"),
        ({"action": "steal"}, "action: expected one of acquire, renew"),
        ({"action": ["take"]}, "action: expected one of"),
        ({"attended": 1}, "attended: expected true or false"),
        ({"answers": None}, "answers: expected a challenge"),
        ({"answers": [1]}, "answers: expected a challenge"),
        ({"answers": [1, -1]}, "answers: expected a challenge"),
        ({"answers": [1.0, 2]}, "answers: expected a challenge"),
        ({"answers": [2**32, 0]}, "answers: expected a challenge"),
        ({"name": "x" * 2000}, "at most 1024 characters"),
    ],
)
def test_request_that_is_none_is_refused_with_the_reason(fields: dict[str, Any], problem: str) -> None:
    assert problem in str(read_request(change(write_request(REQUEST), **fields)))


@pytest.mark.parametrize("text", ["", "take", "[]", "[" * 1000, "null", "1e999"])
def test_text_that_is_no_request_is_refused(text: str) -> None:
    assert isinstance(read_request(text), str)


@pytest.mark.parametrize(
    "fields",
    [
        {"state": "mine"},
        {"state": "free"},
        {"client": ""},
        {"client": "a\n"},
        {"attended": None},
        {"asking": None},
        {"asking": [{"client": ""}]},
        {"asking": [{"client": f"c{n}", "name": ""} for n in range(17)]},
        {"taken_from": "b"},
    ],
)
def test_lease_that_is_none_is_refused(fields: dict[str, Any]) -> None:
    assert read_lease(change(write_lease(LEASE), **fields)) is None


def test_names_are_fit_to_be_shown() -> None:
    assert clean_name("lap\x1b[2Jtop\n\u202e") == "lap[2Jtop"
    assert len(clean_name("n" * 1000)) == LONGEST_NAME
    assert clean_name(None) == ""
    nameless = read_request(change(write_request(REQUEST), name="\n"))
    assert isinstance(nameless, LeaseRequest)
    assert nameless.name == "a1"


json_values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=10),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=8), inner, max_size=3),
    max_leaves=8,
)


@given(st.sampled_from(["client", "name", "program", "action", "attended", "answers"]), json_values)
def test_no_request_raises(field: str, value: Any) -> None:
    read_request(change(write_request(REQUEST), **{field: value}))


@given(
    st.sampled_from(["state", "client", "name", "since", "attended", "asking", "taken_from", "taken_at"]), json_values
)
def test_no_lease_raises(field: str, value: Any) -> None:
    read_lease(change(write_lease(LEASE), **{field: value}))
