import pytest

from ur_nodes.motion.lease.requests import PATIENCE
from ur_nodes.motion.lease.text import FREE, Lease, Viewer
from ur_nodes.web.driving.page_lease import (
    HAND_BACK,
    PageLease,
    may_drive,
    note_end,
    request_action,
    step_page,
)

PAGE = PageLease("web-1", "browser-1")
MINE = Lease("held", "web-1", "phone")
OTHERS = Lease("held", "laptop-1", "laptop")


@pytest.mark.parametrize(
    ("lease", "action"),
    [(None, None), (FREE, None), (OTHERS, None), (MINE, "renew"), (Lease("lost", "web-1"), "renew")],
)
def test_page_renews_what_it_holds_and_else_watches(lease: Lease | None, action: str | None) -> None:
    assert step_page(PAGE, lease, 0.0)[1] == action


def test_page_that_asks_renews_that() -> None:
    asked = Lease("held", "laptop-1", asking=(Viewer("web-1", "phone"),))
    assert step_page(PAGE, asked, 0.0)[1] == "renew"


def test_wish_is_repeated_until_it_has_taken_effect() -> None:
    page = request_action(PAGE, "take", 0.0)
    page, action = step_page(page, OTHERS, 0.2)
    assert action == "take"
    page, action = step_page(page, MINE, 0.4)
    assert action == "renew"
    assert step_page(page, OTHERS, 0.6)[1] is None


def test_wish_that_has_no_effect_is_given_up() -> None:
    assert step_page(request_action(PAGE, "take", 0.0), OTHERS, PATIENCE + 0.1)[1] is None


def test_lease_goes_back_some_seconds_after_the_goal_has_ended() -> None:
    page = note_end(note_end(PAGE, 1.0), 2.0)
    page, action = step_page(page, MINE, 0.9 + HAND_BACK)
    assert action == "renew"
    page, action = step_page(page, MINE, 1.0 + HAND_BACK)
    assert action == "release"
    page, action = step_page(page, MINE, 1.2 + HAND_BACK)
    assert action == "release"  # until it has taken effect
    assert step_page(page, FREE, 1.4 + HAND_BACK)[1] is None


def test_lease_stays_when_the_user_asks_for_it_after_a_goal_and_another_driver_is_left_alone() -> None:
    taken = request_action(note_end(PAGE, 1.0), "take", 1.5)
    assert step_page(taken, MINE, 60.0)[1] == "renew"
    assert step_page(note_end(PAGE, 1.0), OTHERS, 60.0)[1] is None


@pytest.mark.parametrize(
    ("lease", "allowed"),
    [
        (None, True),
        (FREE, True),
        (MINE, True),
        (OTHERS, False),
        (Lease("lost", "laptop-1"), False),
        (Lease("lost", "web-0", computer="browser-1"), True),
        (Lease("held", "web-0", computer="browser-1"), False),
        (Lease("lost", "web-0", computer="browser-2"), False),
    ],
)
def test_page_drives_where_nobody_else_does(lease: Lease | None, allowed: bool) -> None:
    assert may_drive(PAGE, lease) is allowed
