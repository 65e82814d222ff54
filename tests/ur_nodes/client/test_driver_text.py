import pytest

from ur_nodes.client.driver_text import (
    clock_time,
    describe_driver,
    line_of,
    may_command,
)
from ur_nodes.motion.lease.view import Conduct, LeaseView

SINCE = 1_800_000_000.0
OTHER = LeaseView("held", "laptop", "keyboard_drive", SINCE, link_age=0.01)


@pytest.mark.parametrize(
    ("view", "text"),
    [
        (LeaseView(), ""),
        (LeaseView("free", link_age=0.0), ""),
        (LeaseView("held", mine=True, link_age=0.0), ""),
        (LeaseView("held", mine=True, asking=("laptop2",), link_age=0.0), "laptop2 asks to drive; y: hand over"),
        (LeaseView("held", mine=True, link_age=1.23), "no word from the robot for 1.2 s"),
        (LeaseView("held", mine=True), "no word from the robot yet"),
        (OTHER, f"laptop (keyboard_drive) drives the robot since {clock_time(SINCE)}; d: take over, a: ask"),
        (
            LeaseView("held", "laptop", "", SINCE, asks=True, link_age=0.0),
            f"laptop drives the robot since {clock_time(SINCE)}; asked to hand over",
        ),
        (
            LeaseView("held", "laptop2", taken_by="laptop2", taken_at=SINCE + 60, link_age=0.0),
            f"laptop2 took over at {clock_time(SINCE + 60)}; d: take over, a: ask",
        ),
        (LeaseView("lost", "laptop", link_age=0.0), "laptop drove and is out of reach; d: take over"),
        (
            LeaseView("lost", "laptop", "keyboard_drive", SINCE, link_age=0.0, until=SINCE + 60),
            f"laptop (keyboard_drive) drove until {clock_time(SINCE + 60)} and is out of reach; d: take over",
        ),
    ],
)
def test_line_says_who_drives_and_what_can_be_done(view: LeaseView, text: str) -> None:
    assert describe_driver(view) == text


@pytest.mark.parametrize(
    ("view", "conduct", "may"),
    [
        (LeaseView(), "drive", False),
        (LeaseView("free", link_age=0.0), "drive", True),
        (LeaseView("free", link_age=0.0), "watch", False),
        (LeaseView("held", mine=True, link_age=0.0), "watch", True),
        (LeaseView("lost", mine=True, link_age=0.0), "drive", True),
        (OTHER, "take", False),
        (LeaseView("lost", "laptop", link_age=0.0), "drive", False),
    ],
)
def test_keys_are_sent_by_who_drives_or_when_nobody_does(view: LeaseView, conduct: Conduct, may: bool) -> None:
    assert may_command(view, conduct) is may
    assert line_of(view, conduct).blocked is not may


def test_without_a_lease_nothing_is_said() -> None:
    assert (line_of(None).text, line_of(None).blocked) == ("", False)


def test_who_only_watches_is_told_that_nobody_drives() -> None:
    assert describe_driver(LeaseView("free", link_age=0.0), "watch") == "no client drives the robot; d: drive"
