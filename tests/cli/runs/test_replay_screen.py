"""The screen of `ur replay` beside a replay that runs."""

from pathlib import Path

import pytest
from tests.recordings.fake_replay import fake_replay
from textual.widgets import Static

from ur.cli.main import main
from ur.cli.runs.replay_screen import ReplayScreen


async def test_keys_pause_jump_and_change_the_speed(tmp_path: Path) -> None:
    with fake_replay(tmp_path) as replay:
        screen = ReplayScreen({"XDG_STATE_HOME": str(tmp_path)})
        async with screen.run_test(size=(100, 20)) as pilot:
            await pilot.pause()
            assert "playing  3.0 of 120.0 s  speed 1" in str(screen.query_one("#state", Static).render())
            await pilot.press("space")
            assert "paused" in str(screen.query_one("#state", Static).render())
            await pilot.press("space", "left", "right", "comma", "full_stop", "0", "plus", "minus", "minus")
        commands = [("pause", 0), ("play", 0), ("back", 10), ("ahead", 10), ("back", 1), ("ahead", 1), ("jump", 0)]
        assert replay.commands == [*commands, ("speed", 2), ("speed", 1), ("speed", 0.5)]


async def test_screen_ends_with_the_replay(tmp_path: Path) -> None:
    with fake_replay(tmp_path):
        screen = ReplayScreen({"XDG_STATE_HOME": str(tmp_path)})
        async with screen.run_test() as pilot:
            await pilot.pause()
            assert screen.newest is not None
    async with ReplayScreen({"XDG_STATE_HOME": str(tmp_path)}).run_test() as pilot:
        await pilot.pause()
        assert pilot.app.return_code == 0


def test_state_is_printed_without_a_terminal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    with fake_replay(tmp_path):
        assert main(["replay"]) == 0
    assert capsys.readouterr().out == "playing at 3.0 of 120.0 s, speed 1\n"
