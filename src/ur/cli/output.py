"""Output of untrusted texts: table cells without markup, exact bytes, and files."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from ur.source.diagnostic import UserError, error_about
from ur.source.printable import printable

if TYPE_CHECKING:
    from pathlib import Path

    from rich.text import Text


def plain_text(text: str, style: str = "") -> Text:
    """Return a cell of a rich table in which `[red]` is text, without control sequences for the terminal."""
    from rich.text import Text

    return Text(printable(text), style)


def write_exactly(text: str) -> None:
    """Write a text for another program, byte for byte; invalid UTF-8 is written as in its file."""
    sys.stdout.flush()
    sys.stdout.buffer.write(text.encode("utf-8", "surrogateescape"))
    sys.stdout.flush()


def replace_file(path: str | Path, text: str, doing: str = "written", **options: bool) -> None:
    """Replace the content of a file; its permissions stay. Raises UserError, with the file unchanged.

    `doing` completes the message "cannot be ..."; `options` are those of `ur.source.replace.replace_file`.
    """
    from ur.source.replace import replace_file as replace

    try:
        replace(path, text, **options)  # type: ignore[arg-type]  # one of them is a function
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error_about(path, f"cannot be {doing}: {reason}", rule="unwritable-file")) from None
