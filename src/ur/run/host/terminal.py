"""Read and set a terminal's foreground group and modes."""

from __future__ import annotations

import errno
import os
import termios

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

RESET_TERMINAL = (
    b"\x1b[?1049l"  # leave the alternate screen
    b"\x1b[<u"  # leave the kitty keyboard protocol
    b"\x1b[?1000l\x1b[?1002l\x1b[?1003l\x1b[?1006l\x1b[?1015l"  # no mouse reports
    b"\x1b[?1004l\x1b[?2004l"  # no focus reports, no bracketed paste
    b"\x1b[0m\x1b[?25h\r"  # plain text, cursor shown
)


def set_foreground(descriptor: int, group: int) -> None:
    """Make a process group the terminal's foreground group, if this process may change it."""
    try:
        os.tcsetpgrp(descriptor, group)
    except OSError as problem:
        if problem.errno not in (errno.ENOTTY, errno.EPERM, errno.EIO, errno.EINVAL, errno.EBADF):
            raise


def restore_terminal(descriptor: int, attributes: list[Any], *, reset: bool) -> None:
    """Restore the terminal's modes; with `reset` also clear the screen state left by a killed program."""
    try:
        if reset:
            os.write(descriptor, RESET_TERMINAL)
        termios.tcsetattr(descriptor, termios.TCSADRAIN, attributes)
    except (OSError, termios.error):
        return
