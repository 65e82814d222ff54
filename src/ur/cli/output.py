"""Writing what is not ours: cells of tables without markup, and texts that have to arrive as they are."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

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
