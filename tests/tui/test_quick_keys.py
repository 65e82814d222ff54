"""Keys in quick succession, a terminal without colours, and exceptions."""

import asyncio

import pytest
from tests.tui.fake import FakeRun, FakeServices, read_screen, until, watching
from textual import events

from ur.run.clients.protocol import StopRun
from ur.run.supervisor.events import KillNode, StartNode, StopNode
from ur.tui.app import Question, TextDialog, WatchApp
from ur.tui.keys import KEYS

NAMES = [name for key in KEYS for name in key.keys.split(",")]


def press_at_once(app: WatchApp, *keys: str) -> None:
    """Press keys as a terminal delivers those of one read: nothing happens between them."""
    for key in keys:
        app.post_message(events.Key(key, key if len(key) == 1 else None))


@pytest.mark.parametrize("name", [name for name in NAMES if name != "ctrl+c"])
async def test_key_pressed_twice_at_once_leaves_the_interface_running(name: str) -> None:
    async with watching() as (app, pilot, _):
        press_at_once(app, name, name, "escape")
        await pilot.pause()
        assert app.is_running
        assert len(app.screen_stack) <= 2, "one dialog at the most"


async def test_answer_that_follows_its_question_at_once_is_the_answer() -> None:
    async with watching() as (app, pilot, run):
        press_at_once(app, "q", "s")
        await pilot.pause()
        assert [command for command in run.asked() if isinstance(command, (StartNode, StopNode))] == []
        assert [type(command) for command in run.asked()] == [StopRun]


@pytest.mark.parametrize(("keys", "expected"), [("Xss", StopRun), ("kkk", KillNode)])
async def test_answer_pressed_twice_at_once_answers_once(keys: str, expected: type) -> None:
    async with watching() as (app, pilot, run):
        press_at_once(app, "down", *keys)
        await pilot.pause()
        assert [type(command) for command in run.asked()] == [expected]
        assert not isinstance(app.screen, Question)


async def test_double_click_on_an_answer_answers_once() -> None:
    async with watching() as (app, pilot, run):
        await pilot.press("X")
        question = app.screen
        assert isinstance(question, Question)
        question.answer("s")
        question.answer("s")
        await pilot.pause()
        assert [type(command) for command in run.asked()] == [StopRun]


async def test_help_closed_by_two_keys_at_once_closes_only_help() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("question_mark")
        assert isinstance(app.screen, TextDialog)
        press_at_once(app, "escape", "escape")
        await pilot.pause()
        assert app.is_running
        assert not isinstance(app.screen, TextDialog)


async def test_letters_typed_at_once_after_the_search_key_are_searched_for() -> None:
    async with watching() as (app, pilot, run):
        press_at_once(app, "slash", *"xkc")
        await until(pilot, lambda: app.log_view.filter.text == "xkc")
        assert not run.asked()


@pytest.mark.parametrize("size", [(120, 40), (40, 12)], ids=str)
async def test_interface_runs_without_colours(monkeypatch: pytest.MonkeyPatch, size: tuple[int, int]) -> None:
    monkeypatch.setenv("NO_COLOR", "1")
    async with watching(size=size) as (app, pilot, _):
        await pilot.press("question_mark", "escape", "q", "escape")
        await pilot.resize_terminal(size[0] + 9, size[1] + 5)
        await pilot.pause()
        assert "map_server" in "\n".join(read_screen(app))


async def test_exception_ends_the_interface_and_is_kept_for_the_report() -> None:
    run = FakeRun()
    app = WatchApp(run.control, FakeServices())
    app.log_view.show_changes = None  # type: ignore[assignment]  # calling it raises
    await asyncio.wait_for(app.run_async(headless=True, size=(80, 24)), 60)
    run.close()
    assert isinstance(app.problem, TypeError)
