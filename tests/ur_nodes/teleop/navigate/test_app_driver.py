"""The navigation screen while goals are held, the link is lost, or another client drives."""

from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Any

import pytest
import pytest_asyncio
from tests.ur_nodes.teleop.navigate.app_screen import AppScreen, open_app

from ur.source.diagnostic import UserError, error
from ur_nodes.client.driver_text import clock_time
from ur_nodes.client.mux import MuxView
from ur_nodes.client.snapshot import GoalReport, LastGoalState, Silence
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.lease.view import LeaseView

SIZES = [(80, 24), (40, 12)]
THERE = Pose2(2.0, 3.0, 0.0)
MINE = LeaseView("held", "laptop", "keyboard_navigate", 0.0, mine=True, link_age=0.0)
OTHER = LeaseView("held", "laptop2", "keyboard_drive", 100.0, link_age=0.0)
LOST = Silence("the robot", 1.2)


@pytest_asyncio.fixture(params=SIZES, ids=str)
async def screen(request: Any, navigator: Any, store: WaypointStore) -> AsyncIterator[AppScreen]:
    async with open_app(navigator, store, request.param) as shown:
        yield shown


@pytest_asyncio.fixture
async def wide(navigator: Any, store: WaypointStore) -> AsyncIterator[AppScreen]:
    async with open_app(navigator, store, (100, 30)) as shown:
        yield shown


def show(navigator: Any, **changes: Any) -> None:
    navigator.seen = replace(navigator.seen, **changes)


async def test_lost_link_is_shown_and_the_goal_is_unknown_not_failed_or_driving(
    screen: AppScreen, navigator: Any
) -> None:
    await screen.type("g 2 3 90")
    show(navigator, silence=LOST, missing=("an update of the robot's pose",))
    navigator.end(LastGoalState.UNKNOWN)
    await screen.refresh()
    assert "no word from the robot for 1.2 s" in screen.text("status")
    shown = screen.text("status") + screen.text("message")
    assert "driving" not in shown
    assert "failed" not in shown
    show(navigator, silence=None, missing=())
    navigator.end(LastGoalState.DRIVING)
    await screen.refresh()
    assert "driving" in screen.text("status")


async def test_lost_link_says_that_the_goal_is_unknown_where_there_is_room(wide: AppScreen, navigator: Any) -> None:
    await wide.type("g 2 3 90")
    show(navigator, silence=LOST)
    navigator.end(LastGoalState.UNKNOWN)
    await wide.refresh()
    assert "goal unknown until it answers" in wide.text("status")
    assert "m/s" not in wide.text("status")


async def test_no_goal_is_sent_while_the_link_is_lost(screen: AppScreen, navigator: Any) -> None:
    show(navigator, silence=LOST)
    await screen.type("g 2 3 90")
    assert not navigator.goals
    assert "not sent: no word from the robot" in screen.text("message")


async def test_goal_that_cannot_be_sent_in_time_is_said_not_to_be_sent(screen: AppScreen, navigator: Any) -> None:
    navigator.problem = UserError(error("no word from the robot for 0.6 s", rule="no-word"))
    await screen.type("g 2 3 90")
    assert "not sent: no word from the robot for 0.6 s" in screen.text("message")


async def test_stop_that_failed_goes_before_the_lost_link_and_old_news_of_the_mux_after_it(
    screen: AppScreen, navigator: Any
) -> None:
    show(navigator, silence=LOST, mux=MuxView(stopped=True))
    await screen.refresh()
    assert "no word from the robot" in screen.text("status")
    show(navigator, mux=MuxView(problem="NOT STOPPED: no answer"))
    await screen.refresh()
    assert "NOT STOPPED: no answer" in screen.text("status")


async def test_held_goal_says_why(screen: AppScreen, navigator: Any) -> None:
    show(navigator, goal=GoalReport(1, THERE, LastGoalState.HELD, "held: no word from laptop2 for 3 s"))
    await screen.refresh()
    assert "held: no word from laptop2 for 3 s" in screen.text("status")
    assert "driving" not in screen.text("message")


async def test_who_drives_is_shown_and_nothing_is_sent_meanwhile(screen: AppScreen, navigator: Any) -> None:
    show(navigator, lease=OTHER)
    await screen.refresh()
    assert f"laptop2 (keyboard_drive) drives since {clock_time(100.0)}" in screen.text("driver")
    for line in ("g 2 3", "i 1 1 0", "global"):
        await screen.type(line)
        assert "laptop2 (keyboard_drive) drives since" in screen.text("message")
    assert not navigator.goals
    assert (navigator.poses, navigator.searches) == ([], 0)
    await screen.type("s")
    assert navigator.stops == 1, "everybody may stop the robot"


async def test_driver_who_was_taken_over_sees_by_whom_and_may_ask_or_take(screen: AppScreen, navigator: Any) -> None:
    show(navigator, goal=GoalReport(1, THERE, LastGoalState.STOPPED, "laptop2 took over"))
    show(navigator, lease=replace(OTHER, taken_by="laptop2", taken_at=200.0))
    await screen.refresh()
    assert f"laptop2 took over at {clock_time(200.0)}" in screen.text("driver")
    assert "stopped on the way to 2.00 3.00 0: laptop2 took over" in screen.text("message")
    for line in ("ask", "drive", "give", "take"):
        await screen.type(line)
    assert navigator.requests == ["ask", "take", "grant", "take"]


async def test_driver_sees_who_asks_and_the_line_goes_when_nobody_does(screen: AppScreen, navigator: Any) -> None:
    show(navigator, lease=replace(MINE, asking=("laptop2",)))
    await screen.refresh()
    assert "laptop2 asks to drive; 'give' hands over" in screen.text("driver")
    show(navigator, lease=MINE)
    await screen.refresh()
    assert not screen.app.query_one("#driver").display


@pytest.mark.parametrize(
    ("lease", "text"),
    [
        (replace(OTHER, asks=True), "asked to hand over"),
        (
            replace(OTHER, state="lost", until=60.0),
            f"laptop2 (keyboard_drive) drove until {clock_time(60.0)} and is out of reach; drive: take over",
        ),
        (replace(OTHER, state="lost"), "laptop2 (keyboard_drive) drove and is out of reach; drive: take over"),
        (LeaseView("free", taken_by="laptop2", taken_at=1.0), f"laptop2 took over at {clock_time(1.0)} and has left"),
        (LeaseView(), ""),
    ],
)
async def test_line_about_the_driver(wide: AppScreen, navigator: Any, lease: LeaseView, text: str) -> None:
    show(navigator, lease=lease)
    await wide.refresh()
    assert text in wide.text("driver")
    assert wide.app.query_one("#driver").display is bool(text)


async def test_program_that_only_watches_sends_nothing_until_it_drives(screen: AppScreen, navigator: Any) -> None:
    show(navigator, conduct="watch", lease=LeaseView("free", link_age=0.0))
    await screen.refresh()
    assert "no client drives; 'drive' drives" in screen.text("driver")
    await screen.type("g 1 1")
    assert not navigator.goals
    show(navigator, lease=MINE)
    await screen.type("g 1 1")
    assert len(navigator.goals) == 1


async def test_quitting_says_when_the_goal_could_not_be_cancelled(screen: AppScreen, navigator: Any) -> None:
    await screen.type("g 2 3 90")
    show(navigator, silence=LOST)
    assert screen.app.cancel_own_goal() == "no word from the robot for 1.2 s"
    assert navigator.stops == 1
