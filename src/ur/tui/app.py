"""The interface on a large enough terminal: nodes above, log below, keys for everything."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import ClassVar, Protocol

from rich.text import Text
from textual import events
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.driver import Driver
from textual.widgets import Input, Static

from ur.run.client import RunControl
from ur.run.events import (
    KillNode,
    Notice,
    OutputLine,
    RestartNode,
    RunCommand,
    RunEvent,
    StartNode,
    StopNode,
    StopRun,
    Watch,
)
from ur.tui.board import Board, NodeRow, apply_events, begin_board
from ur.tui.dialogs import Choice, Page, Question, read_page
from ur.tui.journal import Journal
from ur.tui.log_view import LogView
from ur.tui.node_table import NodeTable
from ur.tui.palette import DARK, LIGHT
from ur.tui.texts import HELP, describe_filter, describe_run

PAUSE = 0.05  # s between two looks at what has happened: what comes faster is drawn together
RANKS = ((0, "everything"), (2, "warnings"), (3, "errors"))


class Desk(Protocol):
    """What the interface needs of the computer it runs on."""

    def now(self) -> float:
        """The time, in s since the epoch."""

    def find_pager(self) -> list[str] | None:
        """The command that shows a file, None when there is none."""

    def run_here(self, words: Sequence[str]) -> str:
        """Run a command on our terminal, which is free meanwhile. Returns what went wrong, '' when nothing did."""

    def debug(self, row: NodeRow) -> tuple[Sequence[str], bool] | str:
        """The command that debugs a node and whether it needs our terminal, or why there is none."""

    def run_beside(self, words: Sequence[str]) -> str:
        """Start a command that opens a window of its own. Returns what went wrong, '' when nothing did."""


class WatchApp(App[str]):
    """Watches and steers one run. Ends with the run, or with `detached` while the run goes on."""

    CSS_PATH = None
    ENABLE_COMMAND_PALETTE = False
    AUTO_FOCUS = None
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("up", "move(-1)", show=False),
        Binding("down", "move(1)", show=False),
        Binding("pageup", "page(-1)", show=False, priority=True),
        Binding("pagedown", "page(1)", show=False, priority=True),
        Binding("home", "oldest", show=False),
        Binding("end", "newest", show=False),
        Binding("slash", "find", show=False),
        Binding("n", "only_node", show=False),
        Binding("v", "severity", show=False),
        Binding("m", "mute", show=False),
        Binding("escape", "show_all", show=False),
        Binding("s", "start", show=False),
        Binding("x", "stop", show=False),
        Binding("r", "restart", show=False),
        Binding("k", "kill", show=False),
        Binding("X", "stop_all", show=False),
        Binding("l,enter", "open_log", show=False),
        Binding("d", "debug", show=False),
        Binding("c", "clear", show=False),
        Binding("question_mark,f1", "help", show=False),
        Binding("q", "leave", show=False),
        Binding("ctrl+c", "interrupt", show=False, priority=True),
        Binding("ctrl+q", "leave", show=False, priority=True),
    ]
    CSS = """
    Screen { layout: vertical; }
    #head { height: 1; padding: 0 1; }
    #nodes { scrollbar-size-vertical: 1; overflow-x: hidden; }
    #rule { height: 1; }
    #log { height: 1fr; scrollbar-size-vertical: 1; overflow-x: hidden; overflow-y: scroll; }
    #find { height: 1; border: none; padding: 0 1; display: none; }
    #foot { height: 1; padding: 0 1; }
    .dialog { align: center middle; }
    .dialog > Vertical { width: auto; max-width: 90%; height: auto; padding: 1 3; }
    .dialog Static { width: auto; }
    .page { align: center middle; }
    .page > Vertical { width: 94%; height: 94%; padding: 0 2; }
    .page VerticalScroll { height: 1fr; scrollbar-size-vertical: 1; }
    """

    def __init__(
        self,
        control: RunControl,
        desk: Desk,
        *,
        light: bool = False,
        guest: bool = False,
        driver: type[Driver] | None = None,
    ) -> None:
        """`guest`: the run does not end when this interface does."""
        self._palette = LIGHT if light else DARK  # asked for by the constructor of App
        super().__init__(driver_class=driver)
        self.board: Board = begin_board()
        self.journal = Journal()
        self._control = control
        self._desk = desk
        self._guest = guest
        self._rank = 0
        self._stops = 0
        self._said = ""
        self._begun = False
        self.nodes = NodeTable(self._palette)
        self.log_view = LogView(self.journal, self._palette)

    def get_css_variables(self) -> dict[str, str]:
        """Textual's colours, ours where it draws by itself."""
        own = self._palette
        return {
            **super().get_css_variables(),
            "scrollbar": own.chosen,
            "scrollbar-hover": own.quiet,
            "scrollbar-active": own.accent,
            "scrollbar-background": own.ground,
            "scrollbar-background-hover": own.ground,
            "scrollbar-background-active": own.ground,
        }

    def compose(self) -> ComposeResult:
        """One column."""
        yield Static(id="head")
        yield self.nodes
        yield Static(id="rule")
        yield self.log_view
        yield Input(id="find", placeholder="text to look for; Enter keeps it, Escape shows everything")
        yield Static(id="foot")

    def on_mount(self) -> None:
        """Begin to watch."""
        self._begun = True
        own = self._palette
        self.theme = "textual-light" if own.light else "textual-dark"
        self.screen.styles.background = own.ground
        for name in ("#head", "#foot", "#find"):
            self.query_one(name).styles.background = own.raised
        self.query_one("#rule").styles.background = own.ground
        self.set_focus(None)
        self._control.send(Watch(output=True, stats=True, readiness=True))
        asyncio.get_running_loop().add_reader(self._control.fileno(), self._listen)
        self._draw()

    def on_unmount(self) -> None:
        """Watch no longer."""
        asyncio.get_running_loop().remove_reader(self._control.fileno())

    def _listen(self) -> None:
        loop = asyncio.get_running_loop()
        loop.remove_reader(self._control.fileno())  # not again before what came was drawn
        happened = self._control.receive()
        if happened is None:
            self.exit("ended" if self.board.exit_code is not None else "gone")
            return
        self.take(happened)
        if self.is_running:
            loop.call_later(PAUSE, lambda: loop.add_reader(self._control.fileno(), self._listen))

    def take(self, happened: Sequence[RunEvent]) -> None:
        """Show what has happened."""
        self.board = apply_events(self.board, happened)
        self.journal.add((each for each in happened if isinstance(each, (OutputLine, Notice))), self._desk.now())
        if self.board.exit_code is not None:
            self.exit("ended")
            return
        self._draw()

    def on_resize(self, event: events.Resize) -> None:
        """The table gets at most two fifths of the height."""
        self._fit(event.size.height)

    def _fit(self, height: int) -> None:
        wanted = max(2, len(self.board.rows) + 1)
        self.nodes.styles.height = min(wanted, max(4, (height - 3) * 2 // 5))

    def _draw(self) -> None:
        if not self.is_running or not self._begun:
            return
        self._fit(self.size.height)
        self.nodes.muted = self.log_view.filter.muted
        self.nodes.show(self.board.rows)
        self.log_view.show_changes()
        width = self.size.width
        own = self._palette
        self.query_one("#head", Static).update(describe_run(self.board, self._desk.now(), width - 2, own))
        level = next(text for rank, text in RANKS if rank == self._rank)
        rule = describe_filter(self.log_view.filter, level, follows=self.log_view.follows, width=width, palette=own)
        self.query_one("#rule", Static).update(rule)
        self.query_one("#foot", Static).update(self._describe_keys(width - 2))

    def _describe_keys(self, width: int) -> Text:
        own = self._palette
        if self._said:
            return Text(self._said, style=own.yellow, no_wrap=True, overflow="ellipsis")
        text = Text(no_wrap=True, overflow="ellipsis")
        for key, word in (
            ("?", "help"),
            ("q", "quit"),
            ("/", "find"),
            ("n", "this node only"),
            ("v", "severity"),
            ("m", "mute"),
            ("s", "start"),
            ("x", "stop"),
            ("r", "restart"),
            ("k", "kill"),
            ("l", "log"),
            ("d", "debug"),
        ):
            if text.cell_len + len(key) + len(word) + 3 > width:
                break
            text.append(key, f"bold {own.accent}").append(f" {word}  ", own.quiet)
        return text

    def _say(self, text: str) -> None:
        self._said = text
        self._draw()

    def on_key(self) -> None:
        """What was said is read by now."""
        if self._said:
            self._said = ""
            self.call_later(self._draw)

    # Looking.

    def action_move(self, by: int) -> None:
        """Another node."""
        self.nodes.move(by)
        if self.log_view.filter.node:
            self._filter_node()

    def action_page(self, by: int) -> None:
        """Read the log."""
        if isinstance(self.screen, Page):
            scroll = self.screen.query_one("VerticalScroll")
            scroll.scroll_relative(y=by * max(1, scroll.size.height - 1), animate=False)
            return
        step = by * max(1, self.log_view.size.height - 1)
        self.log_view.scroll_relative(y=step, animate=False, immediate=True)
        self.call_after_refresh(self._draw)

    def action_oldest(self) -> None:
        """The beginning of the log."""
        self.log_view.scroll_home(animate=False, immediate=True)
        self.call_after_refresh(self._draw)

    def action_newest(self) -> None:
        """The end of the log, and follow it."""
        self.log_view.scroll_to_end()
        self.call_after_refresh(self._draw)

    def action_find(self) -> None:
        """Ask for a text."""
        field = self.query_one("#find", Input)
        field.display = True
        field.value = self.log_view.filter.text
        self.set_focus(field)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Show while typing."""
        self._filter(text=event.value)

    def on_input_submitted(self) -> None:
        """Keep it."""
        self._close_find(keep=True)

    def _close_find(self, *, keep: bool) -> None:
        field = self.query_one("#find", Input)
        if not keep:
            field.value = ""
            self._filter(text="")
        field.display = False
        self.set_focus(None)

    def action_only_node(self) -> None:
        """Only the node under the cursor, or all again."""
        if self.log_view.filter.node:
            self._filter(node="")
        else:
            self._filter_node()

    def _filter_node(self) -> None:
        row = self.nodes.chosen
        self._filter(node=row.name if row else "")

    def action_severity(self) -> None:
        """Everything, warnings, errors, everything."""
        ranks = [rank for rank, _ in RANKS]
        self._rank = ranks[(ranks.index(self._rank) + 1) % len(ranks)]
        self._filter(rank=self._rank)

    def action_mute(self) -> None:
        """Leave a node out of the log, or take it in again."""
        row = self.nodes.chosen
        if row is not None:
            self._filter(muted=self.log_view.filter.muted ^ {row.name})
            self.nodes.refresh()

    def action_show_all(self) -> None:
        """No filter."""
        self._close_find(keep=False)
        self._rank = 0
        self._filter(node="", rank=0, text="")

    def _filter(self, **changes: object) -> None:
        self.log_view.filter = replace(self.log_view.filter, **changes)  # type: ignore[arg-type]  # fields of Filter
        self.log_view.rebuild()
        self._draw()

    def action_clear(self) -> None:
        """An empty log."""
        self.journal.clear()
        self.log_view.rebuild()

    def action_help(self) -> None:
        """Every key."""
        self.push_screen(Page("Keys", HELP, self._palette))

    def on_node_table_opened(self) -> None:
        """A double click."""
        self.action_open_log()

    def action_open_log(self) -> None:
        """A node's log file, in the pager."""
        row = self.nodes.chosen
        if row is None:
            return
        if not row.changed.log:
            self._say(f"{row.name} has no log file")
            return
        pager = self._desk.find_pager()
        if pager is None:
            self.push_screen(read_page(row.name, row.changed.log, self._palette))
        else:
            self._report(self._desk.run_here([*pager, row.changed.log]))

    # Steering.

    def action_start(self) -> None:
        """Start a node."""
        self._command(StartNode, "start")

    def action_stop(self) -> None:
        """Stop a node and keep it stopped."""
        self._command(StopNode, "stop")

    def action_restart(self) -> None:
        """Stop a node and start it again."""
        self._command(RestartNode, "restart")

    def action_kill(self) -> None:
        """SIGKILL a node, once that is confirmed."""
        row = self._steerable()
        if row is None:
            return

        def answer(key: str | None) -> None:
            if key == "k":
                self._send(KillNode(row.name), f"kill {row.name}")

        choices = (Choice("k", "kill it: it has no chance to tidy up, and is kept stopped"),)
        self.push_screen(Question(f"Kill {row.name}?", choices, self._palette), answer)

    def action_stop_all(self) -> None:
        """End the run, once that is confirmed."""
        self._ask_end(detach=False)

    def action_leave(self) -> None:
        """Quit: end the run, or only stop watching where it goes on without us."""
        if isinstance(self.screen, Question):
            return
        self._ask_end(detach=self._may_leave)

    @property
    def _may_leave(self) -> bool:
        return self._guest or self.board.run.detached

    def _ask_end(self, *, detach: bool) -> None:
        def answer(key: str | None) -> None:
            if key == "s":
                self._stop_run()
            elif key == "d":
                self.exit("detached")

        choices = [Choice("s", "stop everything")]
        if detach:
            choices.append(Choice("d", "detach: leave, everything goes on"))
        title = f"Leave {self.board.run.title}?" if detach else f"Stop {self.board.run.title or 'everything'}?"
        self.push_screen(Question(title, tuple(choices), self._palette), answer)

    def action_interrupt(self) -> None:
        """Ctrl-C: end the run now, as without an interface; of a detached run only ask."""
        if self._may_leave and not self._stops:
            self.action_leave()
        else:
            self._stop_run()

    def _stop_run(self) -> None:
        self._stops += 1
        self._send(StopRun("Ctrl-C" if self._stops == 1 else "Ctrl-C again"), "stopping everything")

    def _steerable(self) -> NodeRow | None:
        row = self.nodes.chosen
        if row is not None and row.changed.core:
            self._say(f"{row.name} belongs to the run itself: it starts first and stops last")
            return None
        return row

    def _command(self, make: Callable[[str], RunCommand], word: str) -> None:
        row = self._steerable()
        if row is not None:
            self._send(make(row.name), f"{word} {row.name}")

    def _send(self, command: RunCommand, said: str) -> None:
        self._control.send(command)
        self._say(said)

    def action_debug(self) -> None:
        """Look into a node with a debugger."""
        row = self._steerable()
        if row is None:
            return
        found = self._desk.debug(row)
        if isinstance(found, str):
            self._say(found)
            return
        words, here = found
        self._report(self._desk.run_here(words) if here else self._desk.run_beside(words))

    def _report(self, problem: str) -> None:
        if problem:
            self._say(problem)
        else:
            self._draw()
