"""Histories of the lease, replayed: who drives after what was requested when."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur_nodes.motion.lease.record import Drove, LeaseEvent, LeaseRecord, may_drive, start_lease, step_lease
from ur_nodes.motion.lease.text import MOST_ASKING, Action, Lease, Person, Request

ACTIONS: tuple[Action, ...] = ("acquire", "renew", "ask", "take", "release", "grant")
UNIX = 1_800_000_000.0


@dataclass
class Desk:
    """A lease and the time."""

    record: LeaseRecord = field(default_factory=start_lease)
    now: float = 0.0

    def request(
        self, client: str, action: Action, *, attended: bool = True, name: str = "", computer: str = ""
    ) -> Lease:
        name = name or f"{client}-host"
        return self.tell(Request(client, name, "keyboard_drive", action, attended, computer=computer))

    def tell(self, event: LeaseEvent | None) -> Lease:
        self.record = step_lease(self.record, event, self.now, UNIX + self.now)
        return self.record.lease

    def wait(self, seconds: float) -> Lease:
        self.now += seconds
        return self.tell(None)


@pytest.fixture
def desk() -> Desk:
    return Desk()


def test_free_lease_is_acquired_with_name_program_and_time(desk: Desk) -> None:
    desk.now = 5.0
    lease = desk.request("a", "acquire")
    assert lease == Lease("held", "a", "a-host", "keyboard_drive", UNIX + 5.0)


def test_held_lease_cannot_be_acquired_but_taken(desk: Desk) -> None:
    desk.request("a", "acquire")
    assert desk.request("b", "acquire").client == "a"
    desk.now = 1.0
    lease = desk.request("b", "take")
    assert (lease.state, lease.client, lease.since) == ("held", "b", UNIX + 1.0)
    assert (lease.taken_from, lease.taken_at) == (Person("a", "a-host"), UNIX + 1.0)


def test_holder_that_is_not_heard_is_lost_and_holds_again_when_it_is(desk: Desk) -> None:
    since = desk.request("a", "acquire").since
    assert desk.wait(2.9).state == "held"
    lease = desk.wait(0.2)
    assert (lease.state, lease.client, lease.until) == ("lost", "a", UNIX)
    desk.wait(1000.0)
    lease = desk.request("a", "renew")
    assert (lease.state, lease.client, lease.since, lease.until) == ("held", "a", since, None)


def test_renewals_and_commands_keep_the_lease(desk: Desk) -> None:
    desk.request("a", "acquire")
    for n in range(20):
        desk.now += 2.0
        lease = desk.request("a", "renew") if n % 2 else desk.tell(Drove("a", motion=False))
        assert lease.state == "held"


@pytest.mark.parametrize("action", ["acquire", "ask"])
def test_lost_lease_is_left_to_its_holder_until_another_takes_it_on_purpose(desk: Desk, action: Action) -> None:
    desk.request("a", "acquire")
    desk.wait(4.0)
    lease = desk.request("b", action)
    assert (lease.state, lease.client) == ("lost", "a")
    assert not may_drive(desk.record, "b")
    lease = desk.request("b", "take")
    assert (lease.state, lease.client, lease.taken_from) == ("held", "b", Person("a", "a-host"))
    assert desk.request("a", "renew").client == "b"


@pytest.mark.parametrize(
    ("name", "computer", "acquired"),
    [
        ("laptop", "c1", True),
        ("renamed", "c1", True),
        ("laptop", "c2", False),  # another computer of the same name
        ("laptop", "", True),  # a client that sends no computer is known by its name
        ("desktop", "", False),
    ],
)
def test_computer_that_has_lost_the_lease_acquires_it_with_another_client(
    desk: Desk, name: str, computer: str, acquired: bool
) -> None:
    desk.request("a", "acquire", name="laptop", computer="c1")
    assert desk.request("b", "acquire", name=name, computer=computer).client == "a", "it may still run"
    desk.wait(4.0)
    assert (desk.request("b", "acquire", name=name, computer=computer).client == "b") is acquired


def test_who_asks_a_lost_holder_is_granted_the_lease_once_it_is_back(desk: Desk) -> None:
    desk.request("a", "acquire")
    desk.wait(4.0)
    assert [each.client for each in desk.request("b", "ask").asking] == ["b"]
    desk.request("a", "renew")
    assert desk.request("a", "grant").client == "b"


def test_lost_holder_is_not_replaced_by_a_command_of_another(desk: Desk) -> None:
    desk.request("a", "acquire")
    desk.wait(4.0)
    assert desk.tell(Drove("b", motion=True)).client == "a"
    assert not may_drive(desk.record, "b")


def test_free_lease_is_acquired_by_a_command_for_motion_with_the_name_that_is_known(desk: Desk) -> None:
    desk.request("a", "renew")
    assert desk.tell(Drove("a", motion=False)).state == "free"
    assert desk.tell(Drove("a", motion=True)).name == "a-host"
    desk.request("a", "release")
    assert desk.tell(Drove("0123456789", motion=True)).name == "01234567"


def test_who_asks_gets_the_lease_by_grant_or_release_in_order(desk: Desk) -> None:
    desk.request("a", "acquire")
    desk.request("b", "ask")
    assert [each.client for each in desk.request("c", "ask").asking] == ["b", "c"]
    assert desk.request("b", "grant").client == "a"  # it is not b's to give
    lease = desk.request("a", "grant")
    assert (lease.client, lease.asking, lease.taken_from) == ("b", (Person("c", "c-host"),), None)
    assert desk.request("b", "release").client == "c"
    assert desk.request("c", "release").state == "free"


def test_who_asks_and_is_not_heard_asks_no_more(desk: Desk) -> None:
    desk.request("a", "acquire")
    desk.request("b", "ask")
    for _ in range(4):
        desk.now += 1.0
        lease = desk.request("a", "renew")
    assert lease.asking == ()
    desk.request("b", "ask")
    for _ in range(4):
        desk.now += 1.0
        desk.request("a", "renew")
        lease = desk.request("b", "renew")
    assert [each.client for each in lease.asking] == ["b"]
    assert desk.request("b", "release").asking == ()


def test_asking_where_nobody_drives_acquires(desk: Desk) -> None:
    assert desk.request("a", "ask").client == "a"


def test_only_so_many_may_ask(desk: Desk) -> None:
    desk.request("a", "acquire")
    for n in range(100):
        lease = desk.request(f"c{n}", "ask")
    assert len(lease.asking) == MOST_ASKING
    assert len(desk.record.known) <= 64


def test_client_without_an_id_drives_and_takes_no_part(desk: Desk) -> None:
    assert desk.tell(Drove("", motion=True)).state == "free"
    desk.request("a", "acquire")
    assert may_drive(desk.record, "")
    assert desk.wait(4.0).state == "lost"
    assert desk.tell(Drove("", motion=True)).state == "lost"


def test_unattended_client_says_so(desk: Desk) -> None:
    assert not desk.request("a", "acquire", attended=False).attended
    assert desk.request("a", "renew", attended=True).attended


def test_holder_of_a_mux_that_died_is_lost_until_it_is_heard(desk: Desk) -> None:
    before = desk.request("a", "acquire")
    desk.record = start_lease(before)
    assert desk.wait(0.0).state == "lost"
    assert desk.request("a", "renew") == before


def test_holder_before_the_master_was_started_anew_is_forgotten_unless_it_returns(desk: Desk) -> None:
    before = desk.request("a", "acquire")
    desk.record = start_lease(before, unix=UNIX, forget_at=60.0)
    assert desk.request("b", "ask").until == UNIX
    assert desk.wait(2.0).client == "a"
    desk.request("a", "renew")
    assert desk.wait(100.0).client == "a", "it was received again: its run goes on"
    desk.record = start_lease(before, unix=UNIX, forget_at=desk.now + 60.0)
    assert desk.wait(59.0).client == "a"
    assert desk.wait(2.0).state == "free"


clients = st.sampled_from(["a", "b", "c"])
events = st.one_of(
    st.none(),
    st.builds(lambda client, action: Request(client, client, "p", action), clients, st.sampled_from(ACTIONS)),
    st.builds(Drove, clients | st.just(""), motion=st.booleans()),
)
histories = st.lists(st.tuples(st.sampled_from([0.0, 0.2, 1.0, 2.9, 3.1]), events), max_size=60)


@given(histories)
@settings(max_examples=300, deadline=None)
def test_invariants_hold_in_any_history(history: list[tuple[float, LeaseEvent | None]]) -> None:
    desk = Desk()
    heard: dict[str, float] = {}
    for pause, event in history:
        desk.now += pause
        before = desk.tell(None)
        after = desk.tell(event)
        if event is not None:
            heard[event.client] = desk.now
        assert (after.state == "free") == (after.client == "")
        assert len({each.client for each in after.asking}) == len(after.asking)
        assert after.client not in {each.client for each in after.asking}
        assert len(desk.record.asked) == len(after.asking)
        assert sum(may_drive(desk.record, client) for client in "abc") in (1, 3)
        if after.state == "held":
            assert desk.now - heard[after.client] <= 3.0
        if before.state == "held" and after.client != before.client:
            assert isinstance(event, Request)
            assert event.action == "take" or event.client == before.client
        if before.state == "lost" and after.client not in ("", before.client):
            assert isinstance(event, Request)
            assert event.action == "take" or event.client == before.client
        assert (after.until is not None) == (after.state == "lost")
        if before.client and after.client not in ("", before.client):
            gone = isinstance(event, Request) and event.client == before.client
            assert (after.taken_from is None) == gone
