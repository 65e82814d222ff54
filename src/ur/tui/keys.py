"""The key bindings with their names. Bindings, the footer and the help page are made from this table."""

from dataclasses import dataclass
from itertools import groupby

from rich.table import Table
from rich.text import Text
from textual.binding import Binding, BindingType

from ur.tui.palette import ScreenPalette


@dataclass(frozen=True, slots=True)
class KeyBinding:
    """One row: textual's names of the keys, the action of the app, and the display name and description of the key.

    `foot` is the word in the footer, '' for none; `group` is that of the help.
    """

    keys: str
    action: str
    shown: str
    does: str
    foot: str = ""
    group: int = 0


KEYS = (
    KeyBinding("up", "move(-1)", "Up, Down", "choose a node; so does a click"),
    KeyBinding("down", "move(1)", "", ""),
    KeyBinding(
        "l,enter", "open_log", "l, Enter", "open its log file ($PAGER, else less); so does a double click", "log"
    ),
    KeyBinding("s", "start", "s", "start it", "start"),
    KeyBinding("x", "stop", "x", "stop it, and keep it stopped", "stop"),
    KeyBinding("r", "restart", "r", "restart it", "restart"),
    KeyBinding("k", "kill", "k", "kill it (asks)", "kill"),
    KeyBinding("d", "debug", "d", "debug it: gdb on a program that runs", "debug"),
    KeyBinding("n", "only_node", "n", "only this node's messages; again: all nodes", "only it", group=1),
    KeyBinding("m", "mute", "m", "mute this node; again: not", "mute", group=1),
    KeyBinding("v", "severity", "v", "everything, warnings and errors, errors only", "severity", group=1),
    KeyBinding("slash", "find", "/", "only messages with a text", "find", group=1),
    KeyBinding("escape", "show_all", "Escape", "everything again; muted nodes stay muted", group=1),
    KeyBinding("pageup", "page(-1)", "Page Up/Down", "read back; so does the mouse wheel", group=1),
    KeyBinding("pagedown", "page(1)", "", "", group=1),
    KeyBinding("home", "oldest", "Home, End", "the oldest message; the newest, and follow", group=1),
    KeyBinding("end", "newest", "", "", group=1),
    KeyBinding("c", "clear", "c", "clear the log; the log files keep everything", group=1),
    KeyBinding("X", "stop_all", "X", "stop everything (asks)", group=2),
    KeyBinding(
        "q", "leave", "q", "quit (asks): stop everything, or detach where the run goes on without you", "quit", group=2
    ),
    KeyBinding("ctrl+q", "leave(True)", "", "", group=2),
    KeyBinding("ctrl+c", "interrupt", "Ctrl-C", "stop everything now; again: faster", group=2),
    KeyBinding("question_mark,f1", "help", "?", "this page; Escape leaves it", "help", group=2),
)
FOOT = "?q/dlxrsknvm"  # the last line names keys in this order, as many as there is room for


def make_bindings() -> list[BindingType]:
    """Return the bindings.

    They come before widgets, so that keys act in the order of typing; see `RunScreen.check_action`.
    """
    return [Binding(name, key.action, show=False, priority=True) for key in KEYS for name in key.keys.split(",")]


def describe_foot(width: int, palette: ScreenPalette) -> Text:
    """Return the footer: the most useful keys, as many as fit."""
    text = Text(no_wrap=True, overflow="ellipsis")
    named = {key.shown.partition(",")[0]: key.foot for key in KEYS}
    for key in FOOT:
        if text.cell_len + len(key) + len(named[key]) + 3 > width:
            break
        text.append(key, f"bold {palette.accent}").append(f" {named[key]}  ", palette.quiet)
    return text


def describe_keys(palette: ScreenPalette) -> Table:
    """Return the help page."""
    table = Table.grid(padding=(0, 2))
    for number, group in groupby((key for key in KEYS if key.does), lambda key: key.group):
        if number:
            table.add_row()
        for key in group:
            table.add_row(Text(key.shown, style=f"bold {palette.accent}", no_wrap=True), key.does)
    return table
