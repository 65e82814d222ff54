"""Every key of the interface does what it says: one row each, and a row for each."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import pytest
from rich.console import Console
from tests.tui.fake import FakeRun, FakeServices, line, until, watching

from ur.run.clients.protocol import StopRun
from ur.run.supervisor.events import RestartNode, StartNode, StopNode
from ur.tui.app import Question, TextDialog, WatchApp
from ur.tui.journal import Filter
from ur.tui.keys import FOOT, KEYS, describe_foot, describe_keys
from ur.tui.palette import DARK

DOCS = Path(__file__).parents[2] / "docs/how-to/watch.md"


@dataclass
class Seen:
    """What a key may change."""

    app: WatchApp
    run: FakeRun
    services: FakeServices

    @property
    def chosen(self) -> str:
        return self.app.nodes.chosen.name if self.app.nodes.chosen else ""

    @property
    def filter(self) -> Filter:
        return self.app.log_view.filter

    @property
    def asks(self) -> str:
        screen = self.app.screen
        return screen.title_text if isinstance(screen, Question) else ""

    @property
    def place(self) -> float:
        return self.app.log_view.scroll_offset.y


Probe = Callable[[Seen], bool]
LOG = [["less", "/logs/map_server-1-stdout.log"]]
# The keys to press before, and what holds after the key and not before it.
CASES: dict[str, tuple[list[str], Probe]] = {
    "up": (["down", "down"], lambda it: it.chosen == "/amcl"),
    "down": ([], lambda it: it.chosen == "/amcl"),
    "l": ([], lambda it: it.services.here == LOG),
    "enter": ([], lambda it: it.services.here == LOG),
    "s": ([], lambda it: it.run.asked() == [StartNode("/map_server")]),
    "x": ([], lambda it: it.run.asked() == [StopNode("/map_server")]),
    "r": ([], lambda it: it.run.asked() == [RestartNode("/map_server")]),
    "k": ([], lambda it: it.asks == "Kill /map_server?"),
    "d": ([], lambda it: it.services.here == [["gdb", "-p", "12"]]),
    "n": ([], lambda it: it.filter == Filter(node="/map_server")),
    "m": ([], lambda it: it.filter == Filter(muted=frozenset({"/map_server"}))),
    "v": ([], lambda it: it.filter == Filter(rank=2)),
    "slash": ([], lambda it: bool(it.app.query_one("#find").display)),
    "escape": (["n", "v"], lambda it: it.filter == Filter()),
    "pageup": ([], lambda it: not it.app.log_view.follows),
    "pagedown": (["home"], lambda it: it.place > 0),
    "home": ([], lambda it: it.place == 0),
    "end": (["home"], lambda it: it.app.log_view.follows),
    "c": ([], lambda it: not it.app.journal.entries),
    "X": ([], lambda it: it.asks == "Stop m_map?"),
    "q": ([], lambda it: it.asks == "Stop m_map?"),
    "ctrl+q": ([], lambda it: it.asks == "Stop m_map?"),
    "ctrl+c": ([], lambda it: it.run.asked() == [StopRun("Ctrl-C")]),
    "question_mark": ([], lambda it: isinstance(it.app.screen, TextDialog)),
    "f1": ([], lambda it: isinstance(it.app.screen, TextDialog)),
}


@pytest.mark.parametrize("key", CASES)
async def test_key_does_what_it_says(key: str) -> None:
    before, holds = CASES[key]
    services = FakeServices()
    async with watching(services=services) as (app, pilot, run):
        run.tell(*(line("/amcl", f"[ INFO] [1.0]: line {number}") for number in range(100)))
        await until(pilot, lambda: app.journal.entries[-1].lines == ["line 99"])
        await pilot.press(*before)
        await pilot.pause()
        seen = Seen(app, run, services)
        assert not holds(seen)
        await pilot.press(key)
        await until(pilot, lambda: holds(seen))


def test_every_key_has_a_case() -> None:
    assert set(CASES) == {name for key in KEYS for name in key.keys.split(",")}
    assert all(hasattr(WatchApp, "action_" + key.action.partition("(")[0]) for key in KEYS)


def test_every_key_is_on_the_help_page_and_in_the_documentation() -> None:
    console = Console(width=100)
    with console.capture() as captured:
        console.print(describe_keys(DARK))
    helped, documented = captured.get(), DOCS.read_text(encoding="utf-8")
    for key in (key for key in KEYS if key.does):
        assert f"{key.shown:<12}  {key.does}" in helped
        for name in key.shown.replace("/Down", ", Page Down").split(", "):
            assert (f"`{name}`" in documented) or (name in documented and len(name) > 1), name


@pytest.mark.parametrize("width", range(0, 130, 7))
def test_last_line_fits_and_begins_with_what_matters(width: int) -> None:
    foot = describe_foot(width, DARK)
    assert foot.cell_len <= width
    assert len(FOOT) == 12
    assert width < 20 or foot.plain.startswith("? help  q quit")


@pytest.mark.parametrize(("opens", "key", "stays"), [
    ("q", "escape", False),
    ("q", "q", False),
    ("q", "z", True),
    ("question_mark", "escape", False),
    ("question_mark", "q", False),
    ("question_mark", "question_mark", False),
    ("question_mark", "enter", False),
    ("question_mark", "l", False),
    ("question_mark", "pagedown", True),
    ("question_mark", "pageup", True),
    ("question_mark", "down", True),
])  # fmt: skip
async def test_key_leaves_a_page_or_question_and_does_nothing_else(opens: str, key: str, stays: bool) -> None:
    services = FakeServices()
    async with watching(services=services) as (app, pilot, run):
        await pilot.press(opens)
        await until(pilot, lambda: isinstance(app.screen, (TextDialog, Question)))
        await pilot.press(key)
        await pilot.pause()
        assert isinstance(app.screen, (TextDialog, Question)) == stays
        assert run.asked() == []
        assert services.here == []
        assert app.nodes.chosen is not None
        assert app.nodes.chosen.name == "/map_server"
