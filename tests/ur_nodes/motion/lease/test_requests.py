"""What a client sends about the lease after it has let go of it."""

from dataclasses import replace

from ur_nodes.motion.lease.requests import LeaseRequests, apply_lease, let_go, step_requests, want
from ur_nodes.motion.lease.text import Lease, Viewer

HELD = Lease(state="held", client="own")


def test_lease_that_is_taken_again_before_the_mux_has_freed_it_is_requested_until_it_is_held() -> None:
    held = apply_lease(LeaseRequests("own", "watch", begun=True), HELD)
    wanted = want(let_go(held, silent=False), "take", 1.0)
    for lease in (None, Lease(), Lease(state="held", client="other")):
        wanted = wanted if lease is None else apply_lease(wanted, lease)
        wanted, action = step_requests(wanted, 1.1, linked=True)
        assert action == "take"
    wanted, action = step_requests(apply_lease(wanted, HELD), 1.2, linked=True)
    assert action == "renew"
    assert wanted.intent is None


def test_client_that_has_let_go_sends_nothing_and_remembers_who_asks() -> None:
    asking = replace(HELD, asking=(Viewer("other"),))
    free = let_go(apply_lease(LeaseRequests("own", "watch", begun=True), asking), silent=False)
    assert free.lease == Lease(asking=asking.asking)
    assert step_requests(free, 1.0, linked=True)[1] is None
