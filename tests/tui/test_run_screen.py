import asyncio
import time
from pathlib import Path

import pytest
from tests.tui.fake import RUN, line, log_of, read_screen, until, watching

from ur.run.clients.protocol import Notice, RunEnded, RunEvent, RunStopping
from ur.tui.journal import MOST_ENTRIES

SNAPSHOTS = Path(__file__).parent / "snapshots"
SIZES = [(120, 40), (80, 24), (60, 15), (40, 10)]
SCREENS = {
    "run": [],
    "help": ["question_mark"],
    "quit": ["q"],
    "kill": ["k"],
    "find": ["slash", *"laser"],
    "filtered": ["down", "n", "v", "m"],
}


@pytest.mark.parametrize("size", SIZES, ids=lambda size: f"{size[0]}x{size[1]}")
@pytest.mark.parametrize("screen", SCREENS)
async def test_screen_looks_as_agreed(screen: str, size: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()
    async with watching(size=size) as (app, pilot, _):
        await until(pilot, lambda: "install it" in "\n".join(read_screen(app)))
        await pilot.press(*SCREENS[screen])
        await pilot.pause()
        found = "\n".join(read_screen(app)) + "\n"
    path = SNAPSHOTS / f"{screen}-{size[0]}x{size[1]}.txt"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        path.write_text(found, encoding="utf-8")
        pytest.fail(f"{path} was missing and has been written: look at it, then run again")
    assert found == path.read_text(encoding="utf-8"), f"if this is how it should be, delete {path} and run again"


async def test_what_was_said_before_the_run_began_is_the_first_in_the_log() -> None:
    early: list[RunEvent] = [Notice("warning", "no display: /rviz left out"), RUN]
    async with watching(early=early) as (app, _pilot, _):
        assert "no display: /rviz left out" in log_of(app).splitlines()[1]


async def test_smaller_terminal_gets_a_smaller_table() -> None:
    async with watching(size=(100, 30)) as (app, pilot, _):
        assert app.nodes.size.height == 7
        await pilot.resize_terminal(100, 10)
        await until(pilot, lambda: app.nodes.size.height < 7)
        assert app.log_view.size.height > 0
        assert len(read_screen(app)) == 10


async def test_flood_neither_freezes_nor_grows() -> None:
    async with watching() as (app, pilot, run):
        for start in range(0, 100_000, 5000):
            lines = [line("/amcl", f"number {number}") for number in range(start, start + 5000)]
            app.show_events(lines)
        assert len(app.journal.entries) <= MOST_ENTRIES
        assert len(app.log_view.rows) <= 2 * MOST_ENTRIES
        run.tell(line("/map_server", "still here"))
        await until(pilot, lambda: "still here" in log_of(app))
        assert "more lines arrived too fast" in log_of(app)


async def test_output_cannot_command_the_terminal() -> None:
    async with watching() as (app, pilot, run):
        run.tell(line("/amcl", "\x1b[2Jcleared\x07 \x9b1m \u202egnirts \x1b[31mred\x1b[0m\ttab"))
        await until(pilot, lambda: "cleared" in log_of(app))
        assert all(each.isprintable() for each in read_screen(app))


async def test_end_of_the_run_ends_the_interface() -> None:
    async with watching() as (app, pilot, run):
        run.tell(RunStopping("Ctrl-C"))
        await until(pilot, lambda: "stopping: Ctrl-C" in read_screen(app)[0])
        run.tell(RunEnded(0))
        await until(pilot, lambda: app.return_value == "ended")


async def test_supervisor_that_is_killed_ends_the_interface() -> None:
    async with watching() as (app, pilot, run):
        run.go()
        await until(pilot, lambda: app.return_value == "killed")
        await asyncio.sleep(0)


async def test_light_terminal_gets_dark_letters() -> None:
    async with watching(light=True) as (app, _pilot, _):
        assert app.theme == "textual-light"
        assert app.screen.styles.background.brightness > 0.9
