"""The interface on a large enough terminal: its actions on nodes, the run and the log, and its dialogs."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

from rich.console import RenderableType
from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Input, Static

from ur.run.clients.protocol import RunCommand, StopRun
from ur.run.clients.run_state import NodeRow
from ur.run.output.node_output import read_last_lines
from ur.run.supervisor.events import CTRL_C, KillNode, RestartNode, StartNode, StopNode
from ur.source.printable import printable
from ur.tui.keys import describe_keys, make_bindings
from ur.tui.palette import ScreenPalette
from ur.tui.run_screen import RANKS, RunScreen


@dataclass(frozen=True, slots=True)
class DialogAnswer:
    """One answer: its key and its text."""

    key: str
    text: str


class Question(ModalScreen[str]):
    """A question; returns the key of a choice, '' for none. Choices can also be clicked."""

    def __init__(self, title: str, choices: tuple[DialogAnswer, ...], palette: ScreenPalette) -> None:
        super().__init__(classes="dialog")
        self.title_text = printable(title)
        self._choices = (*choices, DialogAnswer("escape", "cancel"))
        self._palette = palette
        self._answered = False

    def compose(self) -> ComposeResult:
        """Arrange the question above its answers."""
        with Vertical():
            yield Static(Text(self.title_text, style="bold"))
            yield Static(" ")
            for choice in self._choices:
                yield _Answer(choice, self._palette)

    def on_mount(self) -> None:
        """Set the colours."""
        _frame(self.query_one(Vertical), self._palette)

    def on_key(self, event: events.Key) -> None:
        """Handle an answer, and ignore other keys."""
        event.stop()
        event.prevent_default()
        if any(choice.key == event.key for choice in self._choices):
            self.answer(event.key)
        elif event.key == "q":
            self.answer("escape")

    def answer(self, key: str) -> None:
        """Answer once: a following key or click may be the second of a double one."""
        if not self._answered:
            self._answered = True
            self.dismiss("" if key == "escape" else key)


class _Answer(Static):
    def __init__(self, choice: DialogAnswer, palette: ScreenPalette) -> None:
        key = "esc" if choice.key == "escape" else choice.key
        super().__init__(Text.assemble((f"{key:>3}", f"bold {palette.accent}"), "  ", choice.text))
        self._choice = choice

    def on_click(self) -> None:
        screen = self.screen
        assert isinstance(screen, Question)
        screen.answer(self._choice.key)


class TextDialog(ModalScreen[None]):
    """Text to read: help, or the end of a log file."""

    def __init__(self, title: str, text: RenderableType, palette: ScreenPalette, *, at_end: bool = False) -> None:
        super().__init__(classes="page")
        self._title = printable(title)
        self._text = text
        self._palette = palette
        self._at_end = at_end
        self._left = False

    def compose(self) -> ComposeResult:
        """Arrange the title above the text."""
        with Vertical():
            yield Static(Text(self._title, style="bold", no_wrap=True, overflow="ellipsis"))
            yield Static(" ")
            with VerticalScroll():
                yield Static(self._text)

    def on_mount(self) -> None:
        """Start at the relevant position."""
        _frame(self.query_one(Vertical), self._palette)
        scroll = self.query_one(VerticalScroll)
        scroll.focus()
        if self._at_end:
            scroll.scroll_end(animate=False)

    def on_key(self, event: events.Key) -> None:
        """Close on any of the keys that end a pager."""
        if event.key in ("escape", "q", "l", "enter", "question_mark"):
            event.stop()
            if not self._left:
                self._left = True
                self.dismiss(None)


def _frame(box: Vertical, palette: ScreenPalette) -> None:
    box.styles.background = palette.raised
    box.styles.color = palette.text
    box.styles.border = ("round", palette.quiet)


class LogActions(RunScreen):
    """The actions that change the display."""

    def action_move(self, by: int) -> None:
        """Move the cursor to another node."""
        self.nodes.move(by)
        if self.log_view.filter.node:
            self._filter_node()

    def action_page(self, by: int) -> None:
        """Scroll the log by a page."""
        if isinstance(self.screen, TextDialog):
            scroll = self.screen.query_one(VerticalScroll)
            scroll.scroll_relative(y=by * max(1, scroll.size.height - 1), animate=False)
            return
        step = by * max(1, self.log_view.size.height - 1)
        self.log_view.scroll_relative(y=step, animate=False, immediate=True)
        self.call_after_refresh(self.draw)

    def action_oldest(self) -> None:
        """Scroll to the beginning of the log."""
        self.log_view.scroll_home(animate=False, immediate=True)
        self.call_after_refresh(self.draw)

    def action_newest(self) -> None:
        """Scroll to the end of the log, and follow it."""
        self.log_view.scroll_to_end()
        self.call_after_refresh(self.draw)

    def action_find(self) -> None:
        """Ask for a text to search."""
        field = self.query_one("#find", Input)
        field.display = True
        field.value = self.log_view.filter.text
        self.set_focus(field)

    def on_input_changed(self, event: Input.Changed) -> None:
        """Apply the search text while typing."""
        self._filter(text=event.value)

    def on_input_submitted(self) -> None:
        """Keep the search text."""
        self._close_find(keep=True)

    def _close_find(self, *, keep: bool) -> None:
        field = self.query_one("#find", Input)
        if not keep:
            field.value = ""
            self._filter(text="")
        field.display = False
        self.set_focus(None)

    def action_only_node(self) -> None:
        """Show only the node under the cursor, or all nodes again."""
        if self.log_view.filter.node:
            self._filter(node="")
        else:
            self._filter_node()

    def _filter_node(self) -> None:
        row = self.nodes.chosen
        self._filter(node=row.name if row else "")

    def action_severity(self) -> None:
        """Switch between everything, warnings, and errors."""
        ranks = [rank for rank, _ in RANKS]
        self.rank = ranks[(ranks.index(self.rank) + 1) % len(ranks)]
        self._filter(rank=self.rank)

    def action_mute(self) -> None:
        """Hide a node in the log, or show it again."""
        row = self.nodes.chosen
        if row is not None:
            self._filter(muted=self.log_view.filter.muted ^ {row.name})
            self.nodes.refresh()

    def action_show_all(self) -> None:
        """Remove all filters."""
        self._close_find(keep=False)
        self.rank = 0
        self._filter(node="", rank=0, text="")

    def _filter(self, **changes: object) -> None:
        self.log_view.filter = replace(self.log_view.filter, **changes)  # type: ignore[arg-type]  # fields of Filter
        self.log_view.rebuild()
        self.draw()

    def action_clear(self) -> None:
        """Clear the log."""
        self.journal.clear()
        self.log_view.rebuild()
        self.draw()

    def action_help(self) -> None:
        """Show every key."""
        self.push_screen(TextDialog("Keys", describe_keys(self.palette), self.palette))

    def on_node_table_opened(self) -> None:
        """Open the log after a double click."""
        self.action_open_log()

    def action_open_log(self) -> None:
        """Open a node's log file in the pager."""
        row = self.nodes.chosen
        if row is None:
            return
        if not row.changed.log:
            self.show_notice(f"{row.name} has no log file")
            return
        if not self.services.has_content(row.changed.log):
            self.show_notice(f"{row.name} has printed nothing yet")
            return
        pager = self.services.find_pager()
        if pager is None:
            # A dialog with the end of a node's log file
            lines = read_last_lines(row.changed.log, 2000, 512 * 1024)
            text = Text.from_ansi("\n".join(lines)) if lines else Text("(empty)")
            self.push_screen(TextDialog(f"{row.name}  {row.changed.log}", text, self.palette, at_end=True))
        else:
            self.report(self.services.run_here([*pager, row.changed.log]))

    def report(self, problem: str) -> None:
        """Show a problem ('' for none) and continue."""
        if problem:
            self.show_notice(problem)
        else:
            self.draw()


class WatchApp(LogActions):
    """Shows and controls one run. It ends with the run, or with `detached` while the run continues."""

    BINDINGS: ClassVar[list[BindingType]] = make_bindings()

    _stops = 0

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
        """SIGKILL a node after confirmation."""
        row = self._steerable()
        if row is None:
            return

        def answer(key: str | None) -> None:
            if key == "k":
                self._send(KillNode(row.name), f"kill {row.name}")

        choices = (DialogAnswer("k", "kill it at once; it is kept stopped"),)
        self.push_screen(Question(f"Kill {row.name}?", choices, self.palette), answer)

    def action_debug(self) -> None:
        """Debug a node: gdb on a program that runs."""
        row = self._steerable()
        if row is None:
            return
        found = self.services.debug(row)
        if isinstance(found, str):
            self.show_notice(found)
        else:
            self.report(self.services.run_here(found.argv) if found.here else self.services.run_beside(found.argv))

    def action_stop_all(self) -> None:
        """End the run after confirmation."""
        self._ask_end(detach=False)

    def action_leave(self, _anyway: bool = False) -> None:
        """Quit: end the run, or only this interface if the run continues without it."""
        if not isinstance(self.screen, Question):
            self._ask_end(detach=self._may_leave)

    @property
    def _may_leave(self) -> bool:
        return self.guest or self.state.run.detached

    def _ask_end(self, *, detach: bool) -> None:
        def answer(key: str | None) -> None:
            if key == "s":
                self._stop_run()
            elif key == "d":
                self.exit("detached")

        choices = [DialogAnswer("s", "stop everything")]
        if detach:
            choices.append(DialogAnswer("d", "detach: leave, everything goes on"))
        title = f"Leave {self.state.run.title}?" if detach else f"Stop {self.state.run.title or 'everything'}?"
        self.push_screen(Question(title, tuple(choices), self.palette), answer)

    def action_interrupt(self) -> None:
        """Handle Ctrl-C: end the run immediately, as without an interface; for a detached run only ask."""
        if self._may_leave and not self._stops:
            self.action_leave()
        else:
            self._stop_run()

    def _stop_run(self) -> None:
        self._stops += 1
        self._send(StopRun(CTRL_C if self._stops == 1 else f"{CTRL_C} again"), "stopping everything")

    def _steerable(self) -> NodeRow | None:
        row = self.nodes.chosen
        if row is not None and row.changed.core:
            self.show_notice(f"{row.name} belongs to the run itself: it starts first and stops last")
            return None
        return row

    def _command(self, make: Callable[[str], RunCommand], word: str) -> None:
        row = self._steerable()
        if row is not None:
            self._send(make(row.name), f"{word} {row.name}")

    def _send(self, command: RunCommand, text: str) -> None:
        self.control.send(command)
        self.show_notice(text)
