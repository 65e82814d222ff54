"""The lines above and between, and the help page, as text. Pure."""

from __future__ import annotations

from rich.text import Text

from ur.tui.board import STANDING, Board, Mood
from ur.tui.journal import Filter
from ur.tui.node_table import SIGNS, format_cpu, format_memory
from ur.tui.palette import Palette

_WORDS: dict[Mood, str] = {"up": "up", "busy": "coming or going", "failed": "failed", "idle": "not running"}

HELP = Text(
    """\
 up, down     choose a node; so does a click
 l, Enter     open its log file ($PAGER, else less); so does a double click
 s            start it
 x            stop it, and keep it stopped
 r            restart it
 k            kill it (asks)
 d            debug it: gdb on a running program, or on its core file

 n            only this node's messages; again: all nodes
 m            mute this node; again: not
 v            everything, warnings and errors, errors only
 /            only messages with a text
 Escape       everything again; muted nodes stay muted
 Page Up/Down read back; so does the mouse wheel
 Home, End    the oldest message; the newest, and follow
 c            clear the log; the log files keep everything

 X            stop everything (asks)
 q            quit (asks): stop everything, or detach where the run goes on without you
 Ctrl-C       stop everything now; again: faster
 ?            this page; Escape leaves it
"""
)


def describe_run(board: Board, now: float, width: int, palette: Palette) -> Text:
    """The first line: what runs, how many nodes are how, what they use together, for how long."""
    text = Text(no_wrap=True, overflow="ellipsis")
    text.append(board.run.title or "connecting", f"bold {palette.text}")
    if board.cause is not None:
        text.append("  stopping" + (f": {board.cause}" if board.cause else ""), palette.yellow)
    for mood in STANDING:
        count = board.count()[mood]
        if count:
            text.append(f"   {SIGNS[mood]} {count} ", palette.of_mood(mood)).append(_WORDS[mood], palette.quiet)
    used = [row for row in board.rows if row.memory is not None]
    right = Text()
    if used:
        cpu, memory = sum(row.cpu or 0.0 for row in used), sum(row.memory or 0 for row in used)
        right.append(f"cpu {format_cpu(cpu)}   memory {format_memory(memory)}   ", palette.quiet)
    if board.run.started:
        right.append(format_duration(max(0.0, now - board.run.started)), palette.quiet)
    room = width - text.cell_len - right.cell_len
    if room > 1:
        text.append(" " * room).append_text(right)
    return text


def describe_filter(filter_: Filter, level: str, *, follows: bool, width: int, palette: Palette) -> Text:
    """The line between table and log: what the log shows."""
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
    """How long: `45 s`, `3:07 min`, `2:05:09 h`."""
    whole = int(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    if minutes < 60:
        return f"{minutes}:{rest:02d} min"
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d} h"
