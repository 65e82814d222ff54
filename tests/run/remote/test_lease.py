from __future__ import annotations

import json
import time
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.run.remote.lease import Lease, describe_lease, is_held_by_other, parse_lease

HELD = {
    "state": "held",
    "client": "a1",
    "name": "laptop",
    "program": "keyboard_drive",
    "since": 1_700_000_000,
    "attended": True,
    "asking": [],
    "taken_from": None,
    "taken_at": None,
}


def test_lease_is_read_as_the_multiplexer_writes_it() -> None:
    assert parse_lease(json.dumps(HELD)) == Lease("held", "a1", "laptop", "keyboard_drive", 1_700_000_000.0)
    assert parse_lease('{"state": "free", "client": null, "name": null, "since": null}') == Lease()


@pytest.mark.parametrize(
    "change",
    [
        {"state": "mine"},
        {"name": "x" * 65},
        {"name": "lap\x1b[2Jtop"},
        {"name": ["laptop"]},
        {"program": "a\nb"},
        {"since": "now"},
        {"since": True},
        {"since": float("nan")},
        {"since": -1},
        {"client": {"a": 1}},
    ],
)
def test_lease_that_makes_no_sense_is_refused(change: dict[str, Any]) -> None:
    with pytest.raises((ValueError, TypeError)):
        parse_lease(json.dumps({**HELD, **change}))


@given(st.one_of(st.text(), st.integers(), st.none(), st.binary()))
def test_anything_else_is_refused_without_another_exception(text: object) -> None:
    with pytest.raises((ValueError, TypeError)):
        parse_lease(text)


@pytest.mark.parametrize("text", ["[" * 60000, "x" * 100_000, "[]", "1e999", '{"state": "held", "since": 1e999}'])
def test_hostile_json_is_refused(text: str) -> None:
    with pytest.raises((ValueError, TypeError)):
        parse_lease(text)


def test_driver_is_described_with_the_local_time() -> None:
    now = time.time()
    lease = Lease("held", "a1", "laptop", "keyboard_drive", now - 60)
    when = time.strftime("%H:%M", time.localtime(now - 60))
    assert describe_lease(lease, "bob", now) == f"laptop drives bob since {when} (keyboard_drive)"
    day = time.strftime("%d %b %H:%M", time.localtime(now - 200_000))
    assert (
        describe_lease(Lease("held", "a1", "laptop", "", now - 200_000), "bob", now) == f"laptop drives bob since {day}"
    )


@pytest.mark.parametrize(
    ("lease", "other"),
    [
        (Lease(), False),
        (Lease("lost", "a1", "laptop2"), False),
        (Lease("held", "a1", "laptop2"), True),
        (Lease("held", "killed", "laptop"), False),
        (Lease("held", "own", "laptop"), True),
    ],
)
def test_robot_is_driven_by_others_while_one_of_them_holds_the_lease(lease: Lease, other: bool) -> None:
    assert is_held_by_other(lease, "laptop", ["own"]) is other
