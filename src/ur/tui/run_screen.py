"""The screen of a run: nodes above, log below, updated from events. Its keys are `log_actions` and `app`."""

import asyncio
from collections.abc import Mapping, Sequence
from typing import ClassVar, Protocol

from rich.cells import set_cell_size
from rich.segment import Segment
from rich.style import Style
from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.driver import Driver
from textual.geometry import Size
from textual.message import Message
from textual.screen import ModalScreen
from textual.scroll_view import ScrollView
from textual.strip import Strip
from textual.widgets import Input, Static

from ur.run.clients.client import RunControl
from ur.run.clients.protocol import Notice, OutputLine, RunEvent, RunStopping, Watch, find_severity
from ur.run.clients.run_state import Mood, NodeRow, RunState, apply_events, begin_state
from ur.run.debugger.choice import DebuggerCommand
from ur.source.ansi import strip_styles
from ur.source.printable import printable
from ur.tui.journal import Filter, Journal, clean, strip_head
from ur.tui.keys import describe_foot
from ur.tui.log_view import LogView, short_name
from ur.tui.palette import DARK, LIGHT, ScreenPalette
from ur.tui.screen.app import FullScreenApp

_WORDS: dict[Mood, str] = {"up": "up", "busy": "starting or stopping", "failed": "failed", "idle": "not running"}
_SHORT: dict[Mood, str] = {"up": "up", "busy": "starting", "failed": "failed", "idle": "off"}

SIGNS: dict[Mood, str] = {"up": "●", "busy": "◐", "failed": "✖", "idle": "○"}


def format_memory(memory: int | None) -> str:
    """Format a number of bytes in at most seven characters: `24 MB`."""
    if memory is None:
        return ""
    return f"{memory / 1e9:.1f} GB" if memory >= 1e9 else f"{memory / 1e6:.0f} MB"


def format_cpu(cpu: float | None) -> str:
    """Format cores as per cent of one, in at most six characters: `3 %`."""
    return "" if cpu is None else f"{cpu * 100:.0f} %"


def plan_columns(width: int, names: int, words: int) -> dict[str, int]:
    """Divide the width into columns, one space between them included; columns that do not fit are left out.

    `names` and `words` are the lengths of the longest node name and state. `last` gets the rest.
    """
    columns = {"name": min(max(names, 4), 30, max(8, width // 3)) + 2, "state": min(max(words, 5), 22) + 2}
    rest = width - 3 - sum(columns.values())
    for name, cells, needs in (("cpu", 7, 12), ("memory", 9, 12), ("restarts", 4, 20)):
        if rest - cells >= needs:
            columns[name] = cells
            rest -= cells
    columns["last"] = max(0, rest - 2)
    return columns


class NodeTable(ScrollView, can_focus=False):
    """Shows rows; the cursor stays on its node."""

    class Opened(Message):
        """A node was clicked while the cursor was already on it."""

    def __init__(self, palette: ScreenPalette) -> None:
        super().__init__(id="nodes")
        self.palette = palette
        self.muted: frozenset[str] = frozenset()
        self._rows: tuple[NodeRow, ...] = ()
        self._cursor = 0

    @property
    def chosen(self) -> NodeRow | None:
        """Return the row under the cursor."""
        return self._rows[self._cursor] if self._cursor < len(self._rows) else None

    def show(self, rows: tuple[NodeRow, ...]) -> None:
        """Set new rows."""
        if rows == self._rows:
            return
        chosen = self.chosen
        self._rows = rows
        if chosen is not None:
            self._cursor = next((i for i, row in enumerate(rows) if row.name == chosen.name), 0)
        self.virtual_size = Size(self.size.width, len(rows) + 1)
        self.refresh()

    def move(self, by: int) -> None:
        """Move the cursor."""
        self.choose(self._cursor + by)

    def choose(self, index: int) -> None:
        """Move the cursor to a row."""
        self._cursor = max(0, min(len(self._rows) - 1, index))
        top = self.scroll_offset.y
        height = max(1, self.size.height - 1)
        if self._cursor < top:
            self.scroll_to(y=self._cursor, animate=False, immediate=True)
        elif self._cursor >= top + height:
            self.scroll_to(y=self._cursor - height + 1, animate=False, immediate=True)
        self.refresh()

    def on_click(self, event: events.Click) -> None:
        """Select a node; a second click opens its log."""
        index = event.y + self.scroll_offset.y - 1
        if event.y == 0 or index >= len(self._rows):
            return
        again = index == self._cursor and event.chain > 1
        self.choose(index)
        if again:
            self.post_message(self.Opened())

    def render_line(self, y: int) -> Strip:
        """Return one line; the header comes first and stays in place."""
        names = max((len(row.name.lstrip("/")) for row in self._rows), default=4)
        words = max((len(self._word(row)) for row in self._rows), default=5)
        columns = plan_columns(self.size.width, names, words)
        if y == 0:
            return self._draw_head(columns)
        index = y - 1 + self.scroll_offset.y
        ground = Style(bgcolor=self.palette.ground)
        if index >= len(self._rows):
            return Strip.blank(self.size.width, ground)
        return self._draw_row(self._rows[index], columns, chosen=index == self._cursor)

    def _draw_head(self, columns: dict[str, int]) -> Strip:
        style = Style(color=self.palette.quiet, bgcolor=self.palette.ground)
        words = {
            "name": "node",
            "state": "state",
            "cpu": "cpu",
            "memory": "memory",
            "restarts": "↻",
            "last": "last line",
        }
        return self._draw([("   ", style), *_cells(columns, words, dict.fromkeys(columns, style))], style)

    def _draw_row(self, row: NodeRow, columns: dict[str, int], *, chosen: bool) -> Strip:
        palette = self.palette
        ground = Style(bgcolor=palette.chosen if chosen else palette.ground)
        quiet, text = ground + Style(color=palette.quiet), ground + Style(color=palette.text)
        mood = ground + Style(color=palette.of_mood(row.mood))
        faint = row.changed.core or row.name in self.muted
        last = strip_styles(clean(row.remark))
        severity = find_severity(last)
        words = {
            "name": short_name(row.name, columns["name"] - 2),
            "state": self._word(row),
            "cpu": format_cpu(row.cpu),
            "memory": format_memory(row.memory),
            "restarts": str(row.changed.restarts or ""),
            "last": strip_head(last) if severity else last,
        }
        warns = severity in ("warning", "error", "fatal")
        styles = {
            "name": quiet if faint else text + Style(bold=chosen),
            "state": quiet if faint and row.mood == "up" else mood,
            "cpu": quiet if (row.cpu or 0) < 0.005 else text,
            "memory": quiet,
            "restarts": ground + Style(color=palette.yellow),
            "last": ground + palette.of_severity(severity) if warns else quiet,
        }
        return self._draw([(f" {SIGNS[row.mood]} ", mood), *_cells(columns, words, styles)], ground)

    def _word(self, row: NodeRow) -> str:
        return f"{row.word}, muted" if row.name in self.muted else row.word

    def _draw(self, parts: list[tuple[str, Style]], ground: Style) -> Strip:
        return Strip([Segment(text, style) for text, style in parts]).adjust_cell_length(self.size.width, ground)


def _cells(columns: dict[str, int], words: dict[str, str], styles: dict[str, Style]) -> list[tuple[str, Style]]:
    found = []
    for name, cells in columns.items():
        word = words[name]
        if name in ("cpu", "memory", "restarts"):
            found.append((word.rjust(cells - 1)[: cells - 1] + " ", styles[name]))
        elif name == "last":
            found.append((" ", styles[name]))
            found.append((set_cell_size(word, cells), styles[name]))
        else:
            found.append((set_cell_size(word, cells - 1) + " ", styles[name]))
    return found


def describe_run(state: RunState, now: float, width: int, palette: ScreenPalette) -> Text:
    """Return the first line: the run, the number of nodes in each state, their total usage, and the duration.

    With few columns the labels get shorter, then the usage is left out, then the labels.
    """
    for words, use in ((_WORDS, True), (_SHORT, True), (_SHORT, False), ({}, False)):
        text = Text(style=palette.quiet)
        used = [row for row in state.rows if row.memory is not None]
        if used and use:
            cpu, memory = sum(row.cpu or 0.0 for row in used), sum(row.memory or 0 for row in used)
            text.append(f"cpu {format_cpu(cpu)}   memory {format_memory(memory)}   ")
        if state.run.started:
            text.append(format_duration(max(0.0, now - state.run.started)))
        left, right = _describe_nodes(state, words, palette), text
        room = width - left.cell_len - right.cell_len
        if room > 1:
            return left.append(" " * room).append_text(right)
    return left


def _describe_nodes(state: RunState, words: Mapping[Mood, str], palette: ScreenPalette) -> Text:
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(printable(state.run.title) or "connecting", f"bold {palette.text}")
    if state.cause is not None:
        text.append("  stopping" + (f": {printable(state.cause)}" if state.cause else ""), palette.yellow)
    if state.link and state.cause is None:
        text.append(f"  {printable(state.link)}", f"bold {palette.red}")
    if state.cause is not None and "busy" in words:
        words = {**words, "busy": "stopping"}
    for mood, count in state.count().items():
        if count:
            word = f" {words[mood]}" if words else ""
            text.append(f"   {SIGNS[mood]} {count}", palette.of_mood(mood)).append(word, palette.quiet)
    return text


def describe_filter(filter_: Filter, level: str, *, follows: bool, width: int, palette: ScreenPalette) -> Text:
    """Return the line between table and log, which describes the filter of the log."""
    words = [] if level == "everything" else [f"{level} only" if level == "errors" else "warnings and errors"]
    words += [f"only {filter_.node}"] if filter_.node else []
    words += [f"with {filter_.text!r}"] if filter_.text else []
    words += [f"{len(filter_.muted)} muted"] if filter_.muted else []
    text = Text("── log ", style=palette.quiet, no_wrap=True, overflow="ellipsis")
    if words:
        text.append(", ".join(words) + " ", palette.accent)
    if not follows:
        text.append("· reading back, End follows ", palette.yellow)
    return text.append("─" * max(0, width - text.cell_len), palette.chosen)


def format_duration(seconds: float) -> str:
    """Format a duration: `45 s`, `3:07 min`, `2:05:09 h`."""
    whole = int(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    if minutes < 60:
        return f"{minutes}:{rest:02d} min"
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d} h"


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
