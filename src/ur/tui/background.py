"""Detection of a light or dark terminal background."""

from __future__ import annotations

import os
import re
import select
import termios
import time
import tty
from collections.abc import Mapping

# OSC 11 asks for the background (xterm's ctlseqs); every terminal answers what follows, so that silence is short.
_QUESTION = b"\x1b]11;?\x1b\\\x1b[c"
_COLOUR = re.compile(rb"\]11;rgb:([0-9a-fA-F]+)/([0-9a-fA-F]+)/([0-9a-fA-F]+)")
_END = re.compile(rb"\x1b\[\?[0-9;]*c")


def is_light(environment: Mapping[str, str], answer: bytes) -> bool:
    """Return whether the background is light: as the terminal answered, else as COLORFGBG says, else dark."""
    found = _COLOUR.search(answer)
    if found is None:
        return environment.get("COLORFGBG", "").rpartition(";")[2] in ("7", "15")
    red, green, blue = (int(part, 16) / (16 ** len(part) - 1) for part in found.groups())
    luma: float = 0.2126 * red + 0.7152 * green + 0.0722 * blue  # Rec. 709
    return luma > 0.5


def ask_background(terminal: int, limit: float = 0.25) -> bytes:
    """Return the terminal's answer within `limit` s; empty when it is none. Its modes are as before afterwards."""
    try:
        before = termios.tcgetattr(terminal)
    except termios.error:
        return b""
    answer = b""
    end = time.monotonic() + limit
    try:
        tty.setcbreak(terminal, termios.TCSANOW)
        os.write(terminal, _QUESTION)
        while not _END.search(answer) and (left := end - time.monotonic()) > 0:
            if select.select([terminal], [], [], left)[0]:
                answer += os.read(terminal, 256)
    except OSError:
        return answer
    finally:
        termios.tcsetattr(terminal, termios.TCSANOW, before)
    return answer
