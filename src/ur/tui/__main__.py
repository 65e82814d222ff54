"""The interface as a process: `python -m ur.tui MODE DESCRIPTOR`, started by `ur launch` (see `ur.tui.start`)."""

from __future__ import annotations

import os
import select
import signal
import socket
import sys

from ur.run.client import RunClient
from ur.tui.watch import own_terminal, watch_run


def main(words: list[str]) -> int:
    """Show the run at the other end of an inherited socket until it ends."""
    mode, descriptor = words
    link = socket.socket(fileno=int(descriptor))
    with RunClient(link) as control:
        if mode == "full":
            from ur.tui import app  # noqa: F401 - while the launch file is read: later it is there at once
        select.select([control], [], [])  # nothing is on the screen before the run begins
        if not link.recv(1, socket.MSG_PEEK):
            return 0  # it never begins: ur launch says why
        if not own_terminal(0):
            return 1
        try:
            watch_run(control, mode, os.environ, ours=True)
        except Exception as problem:
            sys.stderr.write(f"error: the interface failed ({problem!r}); lines follow, as with --plain\n")
            return 1
    return 0


if __name__ == "__main__":
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)  # we take the terminal from the background, on purpose
    sys.exit(main(sys.argv[1:]))
