"""Size and background colour of a terminal."""

import os
import re
import select
import termios
import time
import tty
from collections.abc import Mapping

# OSC 11 asks for the background (xterm's ctlseqs). Every terminal answers what follows, so one without OSC 11 is fast.
_QUESTION = b"\x1b]11;?\x1b\\\x1b[c"
_COLOUR = re.compile(rb"\x1b\]11;rgb:([0-9a-fA-F]+)/([0-9a-fA-F]+)/([0-9a-fA-F]+)")
_SEQUENCE = re.compile(rb"\x1b\][^\x07\x1b]*(?:\x07|\x1b\\)|\x1b\[[0-?]*[ -/]*[@-~]|\x1b.?")
_END = re.compile(rb"\x1b\[\?[0-9;]*c")


def measure_terminal(screen: int) -> tuple[int, int] | None:
    """Return columns and rows of the terminal behind a descriptor; None if they are unknown."""
    try:
        columns, rows = os.get_terminal_size(screen)
    except OSError:
        return None
    return (columns, rows) if columns and rows else None


def is_light(environment: Mapping[str, str], answer: bytes) -> bool:
    """Return True for a light background: by the terminal's answer, else by COLORFGBG, else dark."""
    found = _COLOUR.search(answer)
    if found is None:
        return environment.get("COLORFGBG", "").rpartition(";")[2] in ("7", "15")
    red, green, blue = (int(part, 16) / (16 ** len(part) - 1) for part in found.groups())
    luma: float = 0.2126 * red + 0.7152 * green + 0.0722 * blue  # Rec. 709
    return luma > 0.5


def typed_text(answer: bytes) -> str:
    """Return the text that the user has typed meanwhile: the answer without control sequences."""
    text = _SEQUENCE.sub(b"", answer).decode("utf-8", "ignore")
    return "".join(letter for letter in text if letter.isprintable() or letter in "\r\n")


def ask_background(source: int, screen: int, limit: float = 0.3) -> bytes:
    """Ask a terminal for its background and return its answer within `limit` s; empty without one.

    The answer may contain text that the user typed meanwhile (`typed_text`). `source` is the descriptor of its
    keyboard, `screen` that of its output. Its modes are restored afterwards.
    """
    try:
        before = termios.tcgetattr(source)
    except termios.error:
        return b""
    answer = b""
    end = time.monotonic() + limit
    try:
        tty.setcbreak(source, termios.TCSANOW)
        os.write(screen, _QUESTION)
        while not _END.search(answer) and (left := end - time.monotonic()) > 0:
            if select.select([source], [], [], left)[0]:
                answer += os.read(source, 256)
    except OSError:
        return answer
    finally:
        termios.tcsetattr(source, termios.TCSANOW, before)
    return answer
