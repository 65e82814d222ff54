"""A client's view of the lease, and what it requests."""

import pytest

from ur_nodes.motion.lease.text import FREE, Action, Lease, Viewer
from ur_nodes.motion.lease.view import LeaseView, first_action, identify, is_settled, view_lease

MINE = Lease("held", "me", "laptop", "keyboard_drive", 1.8e9)
OTHER = Lease("held", "you", "desktop", "", 1.8e9, True, (Viewer("me", "laptop"), Viewer("3", "phone")))


def test_identity_comes_from_the_environment() -> None:
    found = identify(
        {
            "UR_CLIENT": "a1",
            "UR_CLIENT_NAME": "laptop",
            "UR_COMPUTER": "c1",
            "UR_LEASE": "take",
            "UR_ATTENDED": "0",
        },
        "keyboard_drive",
    )
    assert found.computer == "c1"
    assert (found.client, found.name, found.program) == ("a1", "laptop", "keyboard_drive")
    assert (found.conduct, found.attended) == ("take", False)


@pytest.mark.parametrize(
    "environment", [{}, {"UR_CLIENT": "not an id", "UR_CLIENT_NAME": "\n", "UR_COMPUTER": "a b", "UR_LEASE": "x"}]
)
def test_identity_of_its_own_where_the_environment_gives_none(environment: dict[str, str]) -> None:
    first, second = identify(environment, "p"), identify(environment, "p")
    assert first.client != second.client
    assert first.name
    assert first.computer == ""
    assert (first.conduct, first.attended) == ("drive", True)


@pytest.mark.parametrize(
    ("action", "lease", "settled"),
    [
        ("acquire", FREE, False),
        ("acquire", MINE, True),
        ("acquire", OTHER, False),
        ("take", OTHER, False),
        ("take", MINE, True),
        ("ask", OTHER, True),
        ("ask", FREE, False),
        ("grant", MINE, False),
        ("grant", OTHER, True),
        ("release", MINE, False),
        ("release", OTHER, False),
        ("release", FREE, True),
    ],
)
def test_request_is_repeated_until_it_has_taken_effect(action: Action, lease: Lease, settled: bool) -> None:
    assert is_settled(action, lease, "me") is settled


def test_conduct_says_what_to_request_first() -> None:
    free, lost = FREE, Lease("lost", "other", "laptop")
    assert [first_action(each, free) for each in ("drive", "take", "ask", "watch")] == [None, "take", "ask", None]
    assert [first_action(each, lost) for each in ("drive", "take", "ask", "watch")] == ["acquire", "take", "ask", None]


def test_view_names_others_and_leaves_out_oneself() -> None:
    view = view_lease(OTHER, "me", None, 0.02)
    assert (view.holder, view.mine, view.other, view.asking, view.asks) == ("desktop", False, True, ("phone",), True)
    assert view_lease(MINE, "me", None, 0.02).mine
    assert view_lease(None, "me", None, 0.02).state == "unknown"


def test_view_says_who_took_over() -> None:
    taken = Lease("held", "you", "desktop", "", 1.8e9, taken_from=Viewer("me", "laptop"), taken_at=1.8e9)
    view = view_lease(taken, "me", taken, 0.02)
    assert (view.taken_by, view.taken_at) == ("desktop", 1.8e9)


def test_lost_lease_of_another_is_told_from_ones_own() -> None:
    lost = Lease("lost", "you", "desktop", until=1.8e9)
    view = view_lease(lost, "me", None, 0.02, pending=True)
    assert (view.lost_by_other, view.other, view.until, view.pending) == (True, False, 1.8e9, True)
    assert not view_lease(lost, "you", None, 0.02).lost_by_other


def test_view_forgets_who_took_over_once_somebody_else_drives() -> None:
    taken = Lease("held", "you", "desktop", "", 1.8e9, taken_from=Viewer("me", "laptop"), taken_at=1.8e9)
    third = Lease("held", "3", "phone", "", 1.8e9, taken_from=Viewer("you", "desktop"), taken_at=1.8e9)
    assert view_lease(third, "me", taken, 0.02).taken_by == ""


def test_robot_is_out_of_reach_after_a_second_without_a_challenge() -> None:
    assert not LeaseView(link_age=100.0).out_of_reach  # it was never heard
    assert not LeaseView("free", link_age=0.9).out_of_reach
    assert LeaseView("free", link_age=1.1).out_of_reach
