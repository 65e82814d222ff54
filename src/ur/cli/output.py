"""Output of foreign texts: table cells without markup, exact bytes, and files."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from ur.source.diagnostic import UserError, error_about
from ur.source.printable import printable

if TYPE_CHECKING:
    from rich.text import Text


def plain_text(text: str, style: str = "") -> Text:
    """Make a cell of a rich table: `[red]` in it is text, and nothing in it acts on the terminal."""
    from rich.text import Text

    return Text(printable(text), style)


def write_exactly(text: str) -> None:
    """Write a text that another program reads, byte for byte; bytes that are not UTF-8 are those of the file."""
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode("utf-8", "surrogateescape"))
    sys.stdout.flush()


def replace_file(path: str, text: str, doing: str = "written") -> None:
    """Give a file another content; its permissions stay. Raises UserError; then it is as it was.

    `doing` completes "cannot be ...".
    """
    from ur.source.replace import replace_file as replace

    try:
        replace(path, text)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error_about(path, f"cannot be {doing}: {reason}", rule="unwritable-file")) from None
