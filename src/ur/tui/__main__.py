"""The interface as a process: `python -I -m ur.tui MODE DESCRIPTOR`, started by `ur launch` (see `ur.tui.start`)."""

import os
import select
import signal
import socket
import sys
from pathlib import Path

from ur.run.clients.client import RunClient, RunControl
from ur.run.clients.protocol import RunEvent, RunStarted
from ur.tui.watch import own_terminal, watch_run


def main(argv: list[str]) -> int:
    """Show the run at the other end of an inherited socket until it ends."""
    mode, descriptor = argv
    link = socket.socket(fileno=int(descriptor))
    with RunClient(link) as control:
        if mode == "full":
            from ur.tui import app  # noqa: F401 - while the launch file is read: later it is there at once
        early = wait_begin(control)
        if early is None:
            return 0  # it never begins: ur launch reports why
        if not own_terminal(0):
            return 1
        try:
            watch_run(control, mode, os.environ, ours=True, early=early)
        except Exception as problem:
            from ur.source.crash import EXIT_CODE, describe_crash, write_crash_report

            log_folder = next((event.log_folder for event in early if isinstance(event, RunStarted)), "")
            report = write_crash_report(problem, "ur-tui", [Path(log_folder)] if log_folder else [])
            sys.stderr.write(describe_crash(problem, "ur launch", report) + "\n")
            sys.stderr.write("  help: the run continues, with plain lines as output\n")
            return EXIT_CODE
    return 0


def wait_begin(control: RunControl) -> list[RunEvent] | None:
    """Wait until the run begins; the screen stays empty before. Return the events so far, None if it never begins."""
    early: list[RunEvent] = []
    while not any(isinstance(event, RunStarted) for event in early):
        select.select([control], [], [])
        received = control.receive()
        if received is None:
            return None
        early += received
    return early


if __name__ == "__main__":
    signal.signal(signal.SIGTTOU, signal.SIG_IGN)  # we take the terminal from the background, on purpose
    sys.exit(main(sys.argv[1:]))
