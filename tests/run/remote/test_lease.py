import json
import time
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.run.remote.lease import RobotLease, belongs_to_other, describe_lease, parse_lease

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
    "computer": "c1",
    "until": None,
}


def test_lease_is_read_as_the_multiplexer_writes_it() -> None:
    assert parse_lease(json.dumps(HELD)) == RobotLease("held", "a1", "laptop", "keyboard_drive", 1_700_000_000.0, "c1")
    lost = {**HELD, "state": "lost", "until": 1_700_000_060.5}
    assert parse_lease(json.dumps(lost)).until == 1_700_000_060.5
    assert parse_lease('{"state": "free", "client": null, "name": null, "since": null}') == RobotLease()


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
        {"until": "now"},
        {"computer": "a\nb"},
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
    lease = RobotLease("held", "a1", "laptop", "keyboard_drive", now - 60)
    when = time.strftime("%H:%M", time.localtime(now - 60))
    assert describe_lease(lease, "bob", now) == f"laptop drives bob since {when} (keyboard_drive)"
    day = time.strftime("%d %b %H:%M", time.localtime(now - 200_000))
    assert (
        describe_lease(RobotLease("held", "a1", "laptop", "", now - 200_000), "bob", now)
        == f"laptop drives bob since {day}"
    )


def test_driver_that_is_lost_is_described_with_the_time_of_its_last_word() -> None:
    now = time.time()
    when = time.strftime("%H:%M", time.localtime(now - 60))
    lost = RobotLease("lost", "a1", "laptop", "keyboard_drive", now - 600, until=now - 60)
    assert describe_lease(lost, "bob", now) == f"laptop drove bob until {when} (keyboard_drive) and is out of reach"
    assert describe_lease(RobotLease("lost", "a1"), "bob", now) == "another computer drove bob and is out of reach"


@pytest.mark.parametrize(
    ("lease", "other"),
    [
        (RobotLease(), False),
        (RobotLease("lost", "a1", "laptop2"), True),
        (RobotLease("held", "a1", "laptop2"), True),
        (RobotLease("held", "killed", "laptop"), False),
        (RobotLease("lost", "killed", "laptop"), False),
        (RobotLease("held", "own", "laptop"), True),
        (RobotLease("lost", "killed", "laptop", computer="c1"), False),
        (RobotLease("lost", "killed", "former-name", computer="c1"), False),
        (RobotLease("lost", "a1", "laptop", computer="c2"), True),
        (RobotLease("held", "a1", "laptop", computer="c2"), True),
    ],
)
def test_lease_belongs_to_others_unless_it_is_free_or_of_a_client_here_that_ended(
    lease: RobotLease, other: bool
) -> None:
    assert belongs_to_other(lease, "laptop", "c1", ["own"]) is other
