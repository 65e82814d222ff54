import pytest
from tests.tui.fake import FakeServices, example, read_screen, until, watching

from ur.run.clients.protocol import RunCommand, StopRun
from ur.run.debugger.choice import DebuggerCommand
from ur.run.supervisor.events import KillNode, RestartNode, StartNode, StopNode
from ur.tui.app import Question


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


async def test_kill_asks_first() -> None:
    async with watching() as (app, pilot, run):
        await pilot.press("k")
        assert isinstance(app.screen, Question)
        await pilot.press("escape")
        assert run.asked() == []
        await pilot.press("k", "k")
        await until(pilot, lambda: run.asked() == [KillNode("/map_server")])


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


async def test_debug_opens_a_window_where_there_is_one() -> None:
    services = FakeServices(debugger=DebuggerCommand(("xterm", "-e", "gdb"), here=False))
    async with watching(services=services) as (_, pilot, _run):
        await pilot.press("d")
        assert services.beside == [["xterm", "-e", "gdb"]]


async def test_debug_says_why_it_cannot() -> None:
    async with watching(services=FakeServices(debugger="gdb is not installed")) as (app, pilot, _):
        await pilot.press("d")
        assert read_screen(app)[-1].strip() == "gdb is not installed"
        await pilot.press("down")
        assert "help" in read_screen(app)[-1]


async def test_debugger_that_cannot_be_started_is_explained() -> None:
    async with watching(services=FakeServices(problem="gdb: no such file")) as (app, pilot, _):
        await pilot.press("d")
        assert read_screen(app)[-1].strip() == "gdb: no such file"
