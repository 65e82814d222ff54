"""Diagnostics as text for display."""

import os
from collections.abc import Iterable
from typing import TextIO

from ur.source.ansi import BOLD, CYAN, GREEN, RED, YELLOW, allows_colour, paint
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span
from ur.source.printable import printable

_STYLES = {"error": BOLD + RED, "warning": BOLD + YELLOW, "note": CYAN, "help": GREEN, "path": BOLD}


def shows_colour(stream: TextIO) -> bool:
    """Return True for a terminal that shows colours, unless NO_COLOR is set (no-color.org)."""
    return stream.isatty() and allows_colour(os.environ)


def render_human(diagnostics: Iterable[Diagnostic], *, colour: bool = False) -> str:
    """`path:line:column: severity: message [rule]`, the source line with a caret, notes, one help line.

    The text ends with a newline unless it is empty.
    """
    return "".join(line + "\n" for diagnostic in diagnostics for line in _lines(diagnostic, colour))


def _lines(diagnostic: Diagnostic, colour: bool) -> Iterable[str]:
    severity = diagnostic.severity.value
    where = _paint(f"{printable(str(diagnostic.span))}: ", "path", colour) if diagnostic.span else ""
    yield f"{where}{_paint(severity, severity, colour)}: {printable(diagnostic.message)} [{diagnostic.rule}]"
    if diagnostic.span:
        yield from _excerpt(diagnostic.span, colour, diagnostic.severity)
    for note in diagnostic.notes:
        place = f"{note.span}: " if note.span else ""
        yield f"  {_paint('note', 'note', colour)}: {printable(place + note.message)}"
    if diagnostic.help:
        yield f"  {_paint('help', 'help', colour)}: {printable(diagnostic.help)}"


def _excerpt(span: Span, colour: bool, severity: Severity) -> Iterable[str]:
    line, column = span.position
    text = span.file.line(line)
    if not text.strip():
        return
    width = max(1, min(span.end - span.start, len(text) - column + 1))
    start = max(0, column - 100)  # a caret far to the right is of no use
    shown = _one_cell_each(text[start : start + 160])
    carets = "^" * min(width, max(1, 160 - (column - 1 - start)))
    yield f"  {line:>4} | {shown}"
    yield f"       | {' ' * (column - 1 - start)}{_paint(carets, severity.value, colour)}"


def _one_cell_each(text: str) -> str:
    """Return a source line in which each character is one cell wide, above its caret: tabs are blanks, others `?`."""
    text = text.replace("\t", " ")
    return text if text.isprintable() else "".join(each if printable(each) == each else "?" for each in text)


def _paint(text: str, style: str, colour: bool) -> str:
    return paint(text, _STYLES[style]) if colour else text
