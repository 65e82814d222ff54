"""The lines above and between, as text. Pure."""

from __future__ import annotations

from collections.abc import Mapping

from rich.text import Text

from ur.source.printable import printable
from ur.tui.journal import Filter
from ur.tui.node_table import SIGNS, format_cpu, format_memory
from ur.tui.palette import Palette
from ur.tui.run_state import Mood, RunState

_WORDS: dict[Mood, str] = {"up": "up", "busy": "starting or stopping", "failed": "failed", "idle": "not running"}
_SHORT: dict[Mood, str] = {"up": "up", "busy": "starting", "failed": "failed", "idle": "off"}


def describe_run(state: RunState, now: float, width: int, palette: Palette) -> Text:
    """The first line: what runs, how many nodes are how, what they use together, for how long.

    With few columns the labels get shorter, then the usage is left out, then the labels.
    """
    for words, use in ((_WORDS, True), (_SHORT, True), (_SHORT, False), ({}, False)):
        left, right = _describe_nodes(state, words, palette), _describe_use(state, now, palette, use=use)
        room = width - left.cell_len - right.cell_len
        if room > 1:
            return left.append(" " * room).append_text(right)
    return left


def _describe_nodes(state: RunState, words: Mapping[Mood, str], palette: Palette) -> Text:
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


def _describe_use(state: RunState, now: float, palette: Palette, *, use: bool) -> Text:
    text = Text(style=palette.quiet)
    used = [row for row in state.rows if row.memory is not None]
    if used and use:
        cpu, memory = sum(row.cpu or 0.0 for row in used), sum(row.memory or 0 for row in used)
        text.append(f"cpu {format_cpu(cpu)}   memory {format_memory(memory)}   ")
    if state.run.started:
        text.append(format_duration(max(0.0, now - state.run.started)))
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
    """Format a duration: `45 s`, `3:07 min`, `2:05:09 h`."""
    whole = int(seconds)
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    if minutes < 60:
        return f"{minutes}:{rest:02d} min"
    return f"{minutes // 60}:{minutes % 60:02d}:{rest:02d} h"
