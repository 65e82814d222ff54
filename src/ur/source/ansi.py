"""ANSI escape sequences of terminal output: styles, their removal, and the conditions for sending them."""

import re
from collections.abc import Mapping

RESET, BOLD, DIM, REVERSE = "\x1b[0m", "\x1b[1m", "\x1b[2m", "\x1b[7m"
RED, GREEN, YELLOW, CYAN = "\x1b[31m", "\x1b[32m", "\x1b[33m", "\x1b[36m"

CLEAR_LINE = "\r\x1b[K"
"""Back to the first column, and erase the line."""

STYLE = re.compile(r"\x1b\[([0-9;]*)m")
"""A sequence that sets styles; its group holds the codes."""

_COLOURLESS = ("", "0", "1", "2", "4", "7")  # reset, bold, dim, underlined, reverse


def paint(text: str, *styles: str) -> str:
    """Return a text in styles that end after it."""
    return f"{''.join(styles)}{text}{RESET}"


def strip_styles(text: str) -> str:
    """Return a text without colours and other styles."""
    return STYLE.sub("", text) if "\x1b" in text else text


def strip_colours(text: str) -> str:
    """Return a text without colours; bold, dim, underlined and reverse stay."""
    return STYLE.sub(_without_colour, text)


def cut_styled(line: str, columns: int) -> str:
    """Cut a line to a width in characters, without counting its styles, which end after it."""
    shown, pieces, at = 0, [], 0
    while at < len(line) and shown < columns:
        style = STYLE.match(line, at)
        pieces.append(style[0] if style else line[at])
        shown, at = (shown, style.end()) if style else (shown + 1, at + 1)
    return "".join(pieces) + RESET


def is_plain(environment: Mapping[str, str]) -> bool:
    """Return True for a terminal without escape sequences: TERM is `dumb`, or not set."""
    return environment.get("TERM", "") in ("", "dumb")


def allows_colour(environment: Mapping[str, str]) -> bool:
    """Return False if NO_COLOR is set (no-color.org), or the terminal has no escape sequences."""
    return not environment.get("NO_COLOR") and not is_plain(environment)


def speaks_unicode(encoding: str | None, environment: Mapping[str, str]) -> bool:
    """Return whether a stream of this encoding is read by a user whose locale has more than ASCII."""
    return "utf" in (encoding or "").lower() and environment.get("LC_ALL") not in ("C", "POSIX")


def has_true_colour(environment: Mapping[str, str]) -> bool:
    """Return True for a terminal that declares 24-bit colours."""
    return environment.get("COLORTERM", "") in ("truecolor", "24bit")


def _without_colour(style: re.Match[str]) -> str:
    kept = [code for code in style[1].split(";") if code in _COLOURLESS]
    return f"\x1b[{';'.join(kept)}m" if kept else ""
