from __future__ import annotations

import asyncio
import time
from pathlib import Path

import pytest
from tests.tui.fake import FakeDesk, example, line, read_screen, until, watching
from textual.widgets import Input

from ur.run.events import (
    KillNode,
    NodeChanged,
    RestartNode,
    RunCommand,
    RunEnded,
    RunStopping,
    StartNode,
    StopNode,
    StopRun,
)
from ur.tui.dialogs import Page, Question
from ur.tui.journal import MOST_ENTRIES

SNAPSHOTS = Path(__file__).parent / "snapshots"


def log_of(app: object) -> str:
    screen = read_screen(app)  # type: ignore[arg-type]  # a WatchApp
    start = next(i for i, text in enumerate(screen) if text.startswith("── log"))
    return "\n".join(screen[start:])


@pytest.mark.parametrize("size", [(120, 32), (80, 24), (60, 15)])
async def test_screen_looks_as_agreed(size: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()
    async with watching(size=size) as (app, pilot, _):
        await until(pilot, lambda: "install it" in "\n".join(read_screen(app)))
        found = "\n".join(read_screen(app)) + "\n"
    path = SNAPSHOTS / f"{size[0]}x{size[1]}.txt"
    if not path.exists():
        path.parent.mkdir(exist_ok=True)
        path.write_text(found, encoding="utf-8")
        pytest.fail(f"{path} was missing and has been written: look at it, then run again")
    assert found == path.read_text(encoding="utf-8"), f"if this is how it should be, delete {path} and run again"


@pytest.mark.parametrize(("key", "command"), [
    ("s", StartNode("/amcl")),
    ("x", StopNode("/amcl")),
    ("r", RestartNode("/amcl")),
])  # fmt: skip
async def test_key_steers_the_chosen_node(key: str, command: RunCommand) -> None:
    async with watching() as (app, pilot, run):
        await pilot.press("down", key)
        await until(pilot, lambda: run.asked() == [command])
        assert "/amcl" in read_screen(app)[-1]


async def test_kill_asks_first() -> None:
    async with watching() as (app, pilot, run):
        await pilot.press("k")
        assert isinstance(app.screen, Question)
        await pilot.press("escape")
        assert run.asked() == []
        await pilot.press("k", "k")
        await until(pilot, lambda: run.asked() == [KillNode("/map_server")])


async def test_nodes_of_the_run_itself_are_not_steered() -> None:
    async with watching() as (app, pilot, run):
        await pilot.press(*["down"] * 9, "x", "k", "d")
        assert run.asked() == []
        assert "/master belongs to the run itself" in read_screen(app)[-1]


@pytest.mark.parametrize("key", ["X", "q", "ctrl+q"])
async def test_stop_all_asks_first(key: str) -> None:
    async with watching() as (app, pilot, run):
        await pilot.press(key)
        assert "Stop m_map?" in "\n".join(read_screen(app))
        assert "detach" not in "\n".join(read_screen(app))
        await pilot.press("escape", key, "s")
        await until(pilot, lambda: len(run.asked()) == 1)
        assert isinstance(run.asked()[0], StopRun)


async def test_quit_leaves_a_detached_run_alone() -> None:
    async with watching(*example(detached=True)) as (app, pilot, run):
        await pilot.press("q", "d")
        await until(pilot, lambda: app.return_value == "detached")
        assert run.asked() == []


async def test_guest_may_leave_any_run_alone() -> None:
    async with watching(guest=True) as (app, pilot, run):
        await pilot.press("ctrl+c", "d")
        await until(pilot, lambda: app.return_value == "detached")
        assert run.asked() == []


async def test_interrupt_stops_at_once_and_again_faster() -> None:
    async with watching() as (_, pilot, run):
        await pilot.press("ctrl+c", "ctrl+c")
        await until(pilot, lambda: len(run.asked()) == 2)
        assert all(isinstance(command, StopRun) for command in run.asked())


async def test_interrupt_of_a_detached_run_asks() -> None:
    async with watching(*example(detached=True)) as (app, pilot, run):
        await pilot.press("ctrl+c")
        assert isinstance(app.screen, Question)
        assert run.asked() == []


async def test_answers_can_be_clicked() -> None:
    async with watching() as (app, pilot, run):
        await pilot.press("q")
        text = read_screen(app)
        row = next(i for i, each in enumerate(text) if "stop everything" in each)
        await pilot.click(offset=(text[row].index("stop everything"), row))
        await until(pilot, lambda: len(run.asked()) == 1)


async def test_find_shows_only_messages_with_the_text() -> None:
    async with watching() as (app, pilot, run):
        await pilot.press("slash", *"laser", "enter")
        assert "No laser scan" in log_of(app)
        assert "Read a 312" not in log_of(app)
        assert "with 'laser'" in log_of(app)
        await pilot.press("r")  # steers again, is no text any more
        await until(pilot, lambda: bool(run.asked()))
        await pilot.press("escape")
        assert "Read a 312" in log_of(app)


async def test_escape_leaves_find_and_shows_everything() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("slash", *"laser", "escape")
        assert not app.query_one("#find", Input).display
        assert "Read a 312" in log_of(app)


async def test_only_node_follows_the_cursor() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("n")
        assert "Read a 312" in log_of(app)
        assert "No laser" not in log_of(app)
        await pilot.press("down")
        assert "No laser" in log_of(app)
        assert "Read a 312" not in log_of(app)
        await pilot.press("n")
        assert "Read a 312" in log_of(app)


async def test_severity_goes_round() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("v")
        assert "No laser" in log_of(app)
        assert "Read a 312" not in log_of(app)
        await pilot.press("v")
        assert "No laser" not in log_of(app)
        assert "picamera" in log_of(app)
        await pilot.press("v")
        assert "Read a 312" in log_of(app)


async def test_mute_leaves_a_node_out_until_it_is_pressed_again() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("m", "escape")
        assert "Read a 312" not in log_of(app)
        assert "(muted)" in "\n".join(read_screen(app))
        await pilot.press("m")
        assert "Read a 312" in log_of(app)


async def test_clear_empties_the_log() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("c")
        await until(pilot, lambda: "Read a 312" not in log_of(app))
        assert "amcl" in "\n".join(read_screen(app))


@pytest.mark.parametrize("key", ["l", "enter"])
async def test_log_opens_in_the_pager(key: str) -> None:
    desk = FakeDesk()
    async with watching(desk=desk) as (_, pilot, _run):
        await pilot.press("down", key)
        assert desk.here == [["less", "/logs/amcl-2-stdout.log"]]


async def test_double_click_opens_the_log() -> None:
    desk = FakeDesk()
    async with watching(desk=desk) as (_, pilot, _run):
        await pilot.click("#nodes", offset=(4, 2), times=2)
        await until(pilot, lambda: desk.here == [["less", "/logs/amcl-2-stdout.log"]])


async def test_log_opens_inside_without_a_pager(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_bytes(b"first\n\x1b[31mred\x1b[0m \x1b]0;title\x07 \xff\n")
    async with watching(*example(), NodeChanged("/amcl", "running", pid=12, log=str(tmp_path / "a.log")),
                        desk=FakeDesk(pager=None)) as (app, pilot, _):  # fmt: skip
        await pilot.press("down", "l")
        assert isinstance(app.screen, Page)
        await until(pilot, lambda: "red ?]0;title?" in "\n".join(read_screen(app)))
        await pilot.press("q")
        assert not isinstance(app.screen, Page)


async def test_node_without_log_says_so() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("down", "down", "down", "l")
        assert "/lidar has no log file" in read_screen(app)[-1]


async def test_debug_runs_the_debugger_here() -> None:
    desk = FakeDesk()
    async with watching(desk=desk) as (_, pilot, _run):
        await pilot.press("d")
        assert desk.here == [["gdb", "-p", "12"]]


async def test_debug_opens_a_window_where_there_is_one() -> None:
    desk = FakeDesk(debugger=(("xterm", "-e", "gdb"), False))
    async with watching(desk=desk) as (_, pilot, _run):
        await pilot.press("d")
        assert desk.beside == [["xterm", "-e", "gdb"]]


async def test_debug_says_why_it_cannot() -> None:
    async with watching(desk=FakeDesk(debugger="gdb is not installed")) as (app, pilot, _):
        await pilot.press("d")
        assert read_screen(app)[-1].strip() == "gdb is not installed"
        await pilot.press("down")
        assert "help" in read_screen(app)[-1]


@pytest.mark.parametrize("key", ["question_mark", "f1"])
async def test_help_names_the_keys(key: str) -> None:
    async with watching() as (app, pilot, _):
        await pilot.press(key)
        await until(pilot, lambda: "mute this node" in "\n".join(read_screen(app)))
        await pilot.press("escape")
        assert not isinstance(app.screen, Page)


async def test_reading_back_stays_where_it_is_and_end_follows() -> None:
    async with watching(size=(80, 20)) as (app, pilot, run):
        run.tell(*(line("/amcl", f"line {number}") for number in range(100)))
        await until(pilot, lambda: "line 99" in log_of(app))
        await pilot.press("pageup")
        await until(pilot, lambda: "reading back" in log_of(app))
        seen = [each[:60].rstrip() for each in log_of(app).splitlines()[1:-1]]
        run.tell(line("/amcl", "line 100"))
        await until(pilot, lambda: app.journal.entries[-1].lines == ["line 100"])
        assert [each[:60].rstrip() for each in log_of(app).splitlines()[1:-1]] == seen
        await pilot.press("home")
        await until(pilot, lambda: "Read a 312" in log_of(app))
        await pilot.press("end")
        await until(pilot, lambda: "line 100" in log_of(app))
        await pilot.press("pageup", "pagedown")
        await until(pilot, lambda: "reading back" not in log_of(app))


async def test_cursor_moves_by_keys_and_mouse_and_stays_in_the_table() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("up")
        assert app.nodes.chosen is not None
        assert app.nodes.chosen.name == "/map_server"
        await pilot.click("#nodes", offset=(4, 3))
        assert app.nodes.chosen.name == "/camera"


async def test_flood_neither_freezes_nor_grows() -> None:
    async with watching() as (app, pilot, run):
        for start in range(0, 100_000, 5000):
            lines = [line("/amcl", f"number {number}") for number in range(start, start + 5000)]
            app.take(lines)
        assert len(app.journal.entries) <= MOST_ENTRIES
        assert len(app.log_view.rows) <= 2 * MOST_ENTRIES
        run.tell(line("/map_server", "still here"))
        await until(pilot, lambda: "still here" in log_of(app))
        assert "more lines came too fast" in log_of(app)


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
        await until(pilot, lambda: app.return_value == "gone")
        await asyncio.sleep(0)


async def test_light_terminal_gets_dark_letters() -> None:
    async with watching(light=True) as (app, _pilot, _):
        assert app.theme == "textual-light"
        assert app.screen.styles.background.brightness > 0.9
