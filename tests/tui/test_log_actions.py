from pathlib import Path

import pytest
from tests.tui.fake import FakeServices, example, line, log_of, read_screen, until, watching
from textual.widgets import Input

from ur.run.clients.protocol import NodeChanged
from ur.tui.app import TextDialog


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
        assert ", muted" in "\n".join(read_screen(app))
        await pilot.press("m")
        assert "Read a 312" in log_of(app)


@pytest.mark.parametrize("key", ["l", "enter"])
async def test_log_opens_in_the_pager(key: str) -> None:
    services = FakeServices()
    async with watching(services=services) as (_, pilot, _run):
        await pilot.press("down", key)
        assert services.here == [["less", "/logs/amcl-2-stdout.log"]]


async def test_double_click_opens_the_log() -> None:
    services = FakeServices()
    async with watching(services=services) as (_, pilot, _run):
        await pilot.click("#nodes", offset=(4, 2), times=2)
        await until(pilot, lambda: services.here == [["less", "/logs/amcl-2-stdout.log"]])


async def test_log_opens_inside_without_a_pager(tmp_path: Path) -> None:
    (tmp_path / "a.log").write_bytes(b"first\n\x1b[31mred\x1b[0m \x1b]0;title\x07 \xff\n")
    async with watching(*example(), NodeChanged("/amcl", "running", pid=12, log=str(tmp_path / "a.log")),
                        services=FakeServices(pager=None)) as (app, pilot, _):  # fmt: skip
        await pilot.press("down", "l")
        assert isinstance(app.screen, TextDialog)
        await until(pilot, lambda: "red ?]0;title?" in "\n".join(read_screen(app)))
        await pilot.press("q")
        assert not isinstance(app.screen, TextDialog)


async def test_node_without_log_says_so() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("down", "down", "down", "l")
        assert "/lidar has no log file" in read_screen(app)[-1]


async def test_empty_log_is_named_instead_of_opened() -> None:
    services = FakeServices(empty={"/logs/amcl-2-stdout.log"})
    async with watching(services=services) as (app, pilot, _):
        await pilot.press("down", "l")
        assert "/amcl has printed nothing yet" in read_screen(app)[-1]
        assert services.here == []


async def test_ctrl_z_is_answered() -> None:
    async with watching() as (app, pilot, _):
        await pilot.press("ctrl+z")
        await until(pilot, lambda: any("does not suspend" in each.message for each in app._notifications))


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
