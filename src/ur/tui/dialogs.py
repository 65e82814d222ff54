"""Questions, help, and a log file, over the main screen. One key answers; Escape always closes."""

from dataclasses import dataclass

from rich.console import RenderableType
from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static

from ur.run.output.node_output import read_last_lines
from ur.source.printable import printable
from ur.tui.palette import ScreenPalette


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


def read_page(name: str, path: str, palette: ScreenPalette) -> TextDialog:
    """Return a dialog with the end of a node's log file."""
    lines = read_last_lines(path, 2000, 512 * 1024)
    text = Text.from_ansi("\n".join(lines)) if lines else Text("(empty)")
    return TextDialog(f"{name}  {path}", text, palette, at_end=True)
