"""Display of a run on this terminal, with the suitable interface: for `ur launch` and `ur attach`."""

import os
import signal
import sys
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager

from ur.run.clients.client import RunControl
from ur.run.clients.protocol import RunEvent, StopRun
from ur.run.host import set_foreground

MOST_REPORTED = 12  # lines about failures that stay on the screen afterwards


def watch_run(
    control: RunControl, mode: str, environment: Mapping[str, str], *, ours: bool, early: Sequence[RunEvent] = ()
) -> tuple[str, int]:
    """Show a run until it ends; return `ended`, `killed` (its supervisor was) or `detached`, and its exit code.

    `mode` is `full` or `calm`. `ours`: the run ends with this terminal. `early`: the events so far. Failures, and
    warnings about the end, are printed again afterwards, so that they stay on the terminal.
    """
    if ours:
        signal.signal(signal.SIGHUP, lambda *_: control.send(StopRun("the terminal was closed")))
    if mode == "calm":
        from ur.tui.status_line import show_status_line

        return show_status_line(control, guest=not ours, early=early)
    return _watch_fully(control, environment, early, guest=not ours)


def _watch_fully(
    control: RunControl, environment: Mapping[str, str], early: Sequence[RunEvent], *, guest: bool
) -> tuple[str, int]:
    from textual.drivers.linux_driver import LinuxDriver

    from ur.tui.app import WatchApp
    from ur.tui.screen.query import ask_background, is_light
    from ur.tui.services import SystemServices

    light = is_light(environment, ask_background(1, 1))

    def suspend() -> AbstractContextManager[None]:
        return app.suspend()

    services = SystemServices(environment, suspend)
    app = WatchApp(control, services, light=light, guest=guest, early=early, driver=LinuxDriver)
    how = app.run() or "ended"
    if app.problem is not None:
        raise app.problem
    failures = [entry for entry in app.journal.entries if not entry.name and entry.severity in ("error", "fatal")]
    lines = [line for entry in failures for line in entry.lines]
    for line in (*lines[-MOST_REPORTED:], *app.parting[-MOST_REPORTED:]):
        sys.stderr.write(f"{line}\n")
    if app.state.run.log_folder:
        sys.stderr.write(f"log files in {app.state.run.log_folder}\n")
    return how, app.state.exit_code or 0


def own_terminal(descriptor: int) -> bool:
    """Become the foreground group of the terminal, so that Ctrl-C in a pager or a debugger does not end the run.

    Return False if this process runs in the background, or has no terminal.
    """
    try:
        if os.tcgetpgrp(descriptor) != os.getpgrp():
            return False
        os.setpgid(0, 0)
    except OSError:
        return False
    set_foreground(descriptor, os.getpgrp())
    return True
