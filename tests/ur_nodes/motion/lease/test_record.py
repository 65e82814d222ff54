"""Histories of the lease, replayed: who drives after what was requested when."""

from dataclasses import dataclass, field

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ur_nodes.motion.lease.record import ClientCommand, LeaseEvent, LeaseRecord, may_drive, start_lease, step_lease
from ur_nodes.motion.lease.text import MOST_ASKING, Action, Lease, LeaseRequest, Viewer

ACTIONS: tuple[Action, ...] = ("acquire", "renew", "ask", "take", "release", "grant")
UNIX = 1_800_000_000.0


@dataclass
class LeaseRun:
    """A lease and the time."""

    record: LeaseRecord = field(default_factory=start_lease)
    now: float = 0.0

    def request(
        self, client: str, action: Action, *, attended: bool = True, name: str = "", computer: str = ""
    ) -> Lease:
        name = name or f"{client}-host"
        return self.handle(LeaseRequest(client, name, "keyboard_drive", action, attended, computer=computer))

    def handle(self, event: LeaseEvent | None) -> Lease:
        self.record = step_lease(self.record, event, self.now, UNIX + self.now)
        return self.record.lease

    def wait(self, seconds: float) -> Lease:
        self.now += seconds
        return self.handle(None)


@pytest.fixture
def run() -> LeaseRun:
    return LeaseRun()


def test_free_lease_is_acquired_with_name_program_and_time(run: LeaseRun) -> None:
    run.now = 5.0
    lease = run.request("a", "acquire")
    assert lease == Lease("held", "a", "a-host", "keyboard_drive", UNIX + 5.0)


def test_held_lease_cannot_be_acquired_but_taken(run: LeaseRun) -> None:
    run.request("a", "acquire")
    assert run.request("b", "acquire").client == "a"
    run.now = 1.0
    lease = run.request("b", "take")
    assert (lease.state, lease.client, lease.since) == ("held", "b", UNIX + 1.0)
    assert (lease.taken_from, lease.taken_at) == (Viewer("a", "a-host"), UNIX + 1.0)


def test_holder_that_is_not_heard_is_lost_and_holds_again_when_it_is(run: LeaseRun) -> None:
    since = run.request("a", "acquire").since
    assert run.wait(2.9).state == "held"
    lease = run.wait(0.2)
    assert (lease.state, lease.client, lease.until) == ("lost", "a", UNIX)
    run.wait(1000.0)
    lease = run.request("a", "renew")
    assert (lease.state, lease.client, lease.since, lease.until) == ("held", "a", since, None)


def test_renewals_and_commands_keep_the_lease(run: LeaseRun) -> None:
    run.request("a", "acquire")
    for n in range(20):
        run.now += 2.0
        lease = run.request("a", "renew") if n % 2 else run.handle(ClientCommand("a", motion=False))
        assert lease.state == "held"


@pytest.mark.parametrize("action", ["acquire", "ask"])
def test_lost_lease_is_left_to_its_holder_until_another_takes_it_on_purpose(run: LeaseRun, action: Action) -> None:
    run.request("a", "acquire")
    run.wait(4.0)
    lease = run.request("b", action)
    assert (lease.state, lease.client) == ("lost", "a")
    assert not may_drive(run.record, "b")
    lease = run.request("b", "take")
    assert (lease.state, lease.client, lease.taken_from) == ("held", "b", Viewer("a", "a-host"))
    assert run.request("a", "renew").client == "b"


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
    run: LeaseRun, name: str, computer: str, acquired: bool
) -> None:
    run.request("a", "acquire", name="laptop", computer="c1")
    assert run.request("b", "acquire", name=name, computer=computer).client == "a", "it may still run"
    run.wait(4.0)
    assert (run.request("b", "acquire", name=name, computer=computer).client == "b") is acquired


def test_who_asks_a_lost_holder_is_granted_the_lease_once_it_is_back(run: LeaseRun) -> None:
    run.request("a", "acquire")
    run.wait(4.0)
    assert [each.client for each in run.request("b", "ask").asking] == ["b"]
    run.request("a", "renew")
    assert run.request("a", "grant").client == "b"


def test_lost_holder_is_not_replaced_by_a_command_of_another(run: LeaseRun) -> None:
    run.request("a", "acquire")
    run.wait(4.0)
    assert run.handle(ClientCommand("b", motion=True)).client == "a"
    assert not may_drive(run.record, "b")


def test_free_lease_is_acquired_by_a_command_for_motion_with_the_name_that_is_known(run: LeaseRun) -> None:
    run.request("a", "renew")
    assert run.handle(ClientCommand("a", motion=False)).state == "free"
    assert run.handle(ClientCommand("a", motion=True)).name == "a-host"
    run.request("a", "release")
    assert run.handle(ClientCommand("0123456789", motion=True)).name == "01234567"


def test_who_asks_gets_the_lease_by_grant_or_release_in_order(run: LeaseRun) -> None:
    run.request("a", "acquire")
    run.request("b", "ask")
    assert [each.client for each in run.request("c", "ask").asking] == ["b", "c"]
    assert run.request("b", "grant").client == "a"  # it is not b's to give
    lease = run.request("a", "grant")
    assert (lease.client, lease.asking, lease.taken_from) == ("b", (Viewer("c", "c-host"),), None)
    assert run.request("b", "release").client == "c"
    assert run.request("c", "release").state == "free"


def test_who_asks_and_is_not_heard_asks_no_more(run: LeaseRun) -> None:
    run.request("a", "acquire")
    run.request("b", "ask")
    for _ in range(4):
        run.now += 1.0
        lease = run.request("a", "renew")
    assert lease.asking == ()
    run.request("b", "ask")
    for _ in range(4):
        run.now += 1.0
        run.request("a", "renew")
        lease = run.request("b", "renew")
    assert [each.client for each in lease.asking] == ["b"]
    assert run.request("b", "release").asking == ()


def test_asking_where_nobody_drives_acquires(run: LeaseRun) -> None:
    assert run.request("a", "ask").client == "a"


def test_only_so_many_may_ask(run: LeaseRun) -> None:
    run.request("a", "acquire")
    for n in range(100):
        lease = run.request(f"c{n}", "ask")
    assert len(lease.asking) == MOST_ASKING
    assert len(run.record.known) <= 64


def test_client_without_an_id_drives_where_its_source_follows_the_lease_and_takes_no_part(run: LeaseRun) -> None:
    assert run.handle(ClientCommand("", motion=True)).state == "free"
    run.request("a", "acquire")
    assert may_drive(run.record, "", follows=True)
    assert not may_drive(run.record, "")
    assert run.wait(4.0).state == "lost"
    assert run.handle(ClientCommand("", motion=True)).state == "lost"


def test_unattended_client_says_so(run: LeaseRun) -> None:
    assert not run.request("a", "acquire", attended=False).attended
    assert run.request("a", "renew", attended=True).attended


def test_holder_of_a_mux_that_died_is_lost_until_it_is_heard(run: LeaseRun) -> None:
    before = run.request("a", "acquire")
    run.record = start_lease(before)
    assert run.wait(0.0).state == "lost"
    assert run.request("a", "renew") == before


def test_holder_before_the_master_was_started_anew_is_forgotten_unless_it_returns(run: LeaseRun) -> None:
    before = run.request("a", "acquire")
    run.record = start_lease(before, unix=UNIX, forget_at=60.0)
    assert run.request("b", "ask").until == UNIX
    assert run.wait(2.0).client == "a"
    run.request("a", "renew")
    assert run.wait(100.0).client == "a", "it was received again: its run goes on"
    run.record = start_lease(before, unix=UNIX, forget_at=run.now + 60.0)
    assert run.wait(59.0).client == "a"
    assert run.wait(2.0).state == "free"


clients = st.sampled_from(["a", "b", "c"])
events = st.one_of(
    st.none(),
    st.builds(lambda client, action: LeaseRequest(client, client, "p", action), clients, st.sampled_from(ACTIONS)),
    st.builds(ClientCommand, clients | st.just(""), motion=st.booleans()),
)
histories = st.lists(st.tuples(st.sampled_from([0.0, 0.2, 1.0, 2.9, 3.1]), events), max_size=60)


@given(histories)
@settings(max_examples=300, deadline=None)
def test_invariants_hold_in_any_history(history: list[tuple[float, LeaseEvent | None]]) -> None:
    run = LeaseRun()
    received: dict[str, float] = {}
    for pause, event in history:
        run.now += pause
        before = run.handle(None)
        after = run.handle(event)
        if event is not None:
            received[event.client] = run.now
        assert (after.state == "free") == (after.client == "")
        assert len({each.client for each in after.asking}) == len(after.asking)
        assert after.client not in {each.client for each in after.asking}
        assert len(run.record.asked) == len(after.asking)
        assert sum(may_drive(run.record, client) for client in "abc") in (1, 3)
        if after.state == "held":
            assert run.now - received[after.client] <= 3.0
        if before.state == "held" and after.client != before.client:
            assert isinstance(event, LeaseRequest)
            assert event.action == "take" or event.client == before.client
        if before.state == "lost" and after.client not in ("", before.client):
            assert isinstance(event, LeaseRequest)
            assert event.action == "take" or event.client == before.client
        assert (after.until is not None) == (after.state == "lost")
        if before.client and after.client not in ("", before.client):
            gone = isinstance(event, LeaseRequest) and event.client == before.client
            assert (after.taken_from is None) == gone
