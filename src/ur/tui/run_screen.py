"""The screen of a run: nodes above, log below, updated from events. Its keys are `log_actions` and `app`."""

import asyncio
from collections.abc import Sequence
from typing import ClassVar, Protocol

from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.driver import Driver
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from ur.run.clients.client import RunControl
from ur.run.clients.protocol import Notice, OutputLine, RunEvent, RunStopping, Watch
from ur.run.clients.run_state import NodeRow, RunState, apply_events, begin_state
from ur.run.debugger.choice import DebuggerCommand
from ur.source.printable import printable
from ur.tui.journal import Journal
from ur.tui.keys import describe_foot
from ur.tui.log_view import LogView
from ur.tui.node_table import NodeTable, describe_filter, describe_run
from ur.tui.palette import DARK, LIGHT
from ur.tui.screen.app import FullScreenApp

PAUSE = 0.05  # s between two updates of the screen: faster events are drawn together
RANKS = ((0, "everything"), (2, "warnings"), (3, "errors"))

_LAYOUT = """
Screen { layout: vertical; }
#head { height: 1; padding: 0 1; }
#nodes { scrollbar-size-vertical: 1; overflow-x: hidden; }
#rule { height: 1; }
#log { height: 1fr; scrollbar-size-vertical: 1; overflow-x: hidden; overflow-y: scroll; }
#find { height: 1; border: none; padding: 0 1; display: none; }
#foot { height: 1; padding: 0 1; }
.dialog { align: center middle; }
.dialog > Vertical { width: auto; max-width: 100%; height: auto; max-height: 100%; padding: 0 2; overflow-y: auto; }
.dialog Static { width: auto; max-width: 100%; }
.page { align: center middle; }
.page > Vertical { width: 94%; height: 94%; padding: 0 2; }
.page VerticalScroll { height: 1fr; scrollbar-size-vertical: 1; }
"""


class Services(Protocol):
    """The services of the computer that the interface needs."""

    def now(self) -> float:
        """Return the time in s since the epoch."""

    def has_content(self, path: str) -> bool:
        """Return whether a file exists and is not empty."""

    def find_pager(self) -> list[str] | None:
        """Return the command that shows a file, None if there is none."""

    def run_here(self, words: Sequence[str]) -> str:
        """Run a command on this terminal, which is released meanwhile. Return the problem, '' for none."""

    def debug(self, row: NodeRow) -> DebuggerCommand | str:
        """Return the debugger for a node, or the reason why there is none."""

    def run_beside(self, words: Sequence[str]) -> str:
        """Start a command that opens a separate window. Return the problem, '' for none."""


class RunScreen(FullScreenApp[str]):
    """Shows one run, and ends with it."""

    CSS_PATH = None
    AUTO_FOCUS: ClassVar[str | None] = None
    CSS = _LAYOUT

    def __init__(
        self,
        control: RunControl,
        services: Services,
        *,
        light: bool = False,
        guest: bool = False,
        early: Sequence[RunEvent] = (),
        driver: type[Driver] | None = None,
    ) -> None:
        """Create the screen. `guest`: the run does not end with this interface. `early`: the events so far."""
        self.palette = LIGHT if light else DARK  # asked for by the constructor of the application
        super().__init__(driver_class=driver)
        self.state: RunState = begin_state()
        self.journal = Journal()
        self.control = control
        self.services = services
        self.guest = guest
        self.rank = 0  # of the severities that are shown
        self.nodes = NodeTable(self.palette)
        self.log_view = LogView(self.journal, self.palette)
        self._early = early
        self._notice = ""
        self._begun = False
        self._stopping = False
        self.parting: list[str] = []  # warnings since the run stops

    def get_css_variables(self) -> dict[str, str]:
        """Return Textual's colours, replaced by the palette's where Textual draws by itself."""
        own = self.palette
        ground = ("scrollbar-background", "scrollbar-background-hover", "scrollbar-background-active")
        bars = {"scrollbar": own.chosen, "scrollbar-hover": own.quiet, "scrollbar-active": own.accent}
        return {**super().get_css_variables(), **bars, **dict.fromkeys(ground, own.ground)}

    def compose(self) -> ComposeResult:
        """Arrange the widgets in one column."""
        yield Static(id="head")
        yield self.nodes
        yield Static(id="rule")
        yield self.log_view
        yield Input(id="find", placeholder="text to search for; Enter keeps the filter, Escape clears it")
        yield Static(id="foot")

    def on_mount(self) -> None:
        """Start to follow the run."""
        self._begun = True
        own = self.palette
        self.use_theme(light=own.light)
        self.screen.styles.background = own.ground
        for name in ("#head", "#foot", "#find"):
            self.query_one(name).styles.background = own.raised
        self.query_one("#rule").styles.background = own.ground
        self.set_focus(None)
        self.control.send(Watch(output=True, stats=True, readiness=True))
        asyncio.get_running_loop().add_reader(self.control.fileno(), self._listen)
        self.show_events(self._early)

    def on_unmount(self) -> None:
        """Stop following the run."""
        asyncio.get_running_loop().remove_reader(self.control.fileno())

    def _listen(self) -> None:
        loop = asyncio.get_running_loop()
        loop.remove_reader(self.control.fileno())  # not again before the received events were drawn
        received = self.control.receive()
        if received is None:
            self.exit("ended" if self.state.exit_code is not None else "killed")
            return
        self.show_events(received)
        if self.is_running:
            loop.call_later(PAUSE, lambda: loop.add_reader(self.control.fileno(), self._listen))

    def show_events(self, received: Sequence[RunEvent]) -> None:
        """Show events."""
        for each in received:
            self._stopping = self._stopping or isinstance(each, RunStopping)
            if self._stopping and isinstance(each, Notice) and each.severity == "warning":
                self.parting += each.text.split("\n")
        self.state = apply_events(self.state, received)
        self.journal.add((each for each in received if isinstance(each, (OutputLine, Notice))), self.services.now())
        if self.state.exit_code is not None:
            self.exit("ended")
            return
        self.draw()

    def on_resize(self, event: events.Resize) -> None:
        """Limit the table to two fifths of the height."""
        self._fit(event.size.height)
        self.call_after_refresh(self.draw)

    def _fit(self, height: int) -> None:
        wanted = max(2, len(self.state.rows) + 1)
        self.nodes.styles.height = min(wanted, max(min(4, height // 2), (height - 3) * 2 // 5))

    def draw(self) -> None:
        """Update the whole screen."""
        if not self.is_running or not self._begun:
            return
        self._fit(self.size.height)
        self.nodes.muted = self.log_view.filter.muted
        self.nodes.show(self.state.rows)
        self.log_view.show_changes()
        width = self.size.width
        own = self.palette
        self._write("#head", describe_run(self.state, self.services.now(), width - 2, own))
        level = next(text for rank, text in RANKS if rank == self.rank)
        rule = describe_filter(self.log_view.filter, level, follows=self.log_view.follows, width=width, palette=own)
        self._write("#rule", rule)
        notice = Text(self._notice, style=own.yellow, no_wrap=True, overflow="ellipsis")
        self._write("#foot", notice if self._notice else describe_foot(width - 2, own))

    def _write(self, place: str, text: Text) -> None:
        self.query_one(place, Static).update(text)

    def show_notice(self, text: str) -> None:
        """Show a message until the next key."""
        self._notice = printable(text)
        self.draw()

    async def on_event(self, event: events.Event) -> None:
        """Handle an event. A key dismisses the last notice."""
        if isinstance(event, events.Key) and not event.is_forwarded and self._notice:
            self._notice = ""
            self.call_later(self.draw)
        await super().on_event(event)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Leave keys to a dialog, and letters to an input field."""
        if action in ("page", "interrupt") or (action == "leave" and parameters):
            return True
        if isinstance(self.screen, ModalScreen):
            return False
        return not isinstance(self.focused, Input) or action in ("show_all", "move")
