"""Monitor of a master that another process runs."""

from __future__ import annotations

import threading
from collections.abc import Callable

from ur.run.master.client import Master
from ur.run.master.link_monitor import watch_link
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.paths import is_local_address
from ur.run.supervisor.events import Event, MasterLost, MasterReplaced, MasterReturned

PERIOD = 3.0  # s between two polls
LOST_PERIOD = 0.5  # the same while the master does not answer
MISSES = 2  # failures in a row before the master counts as lost: a busy computer may answer late


def start_watch(master: Master | None, report: Callable[[Event], None]) -> threading.Event:
    """Monitor a local master, or a robot's master and the link to it, in a thread until the event is set."""
    over = threading.Event()
    if master is not None:
        watch = watch_master if is_local_address(master.host) else watch_link
        threading.Thread(target=watch, args=(master, report, over), daemon=True).start()
    return over


def watch_master(master: Master, report: Callable[[Event], None], over: threading.Event) -> None:
    """Monitor a master until `over`; report that it is lost, answers again, or was replaced by another one.

    A master is identified by its process id: a restarted one has another id, and no registered nodes.
    """
    known = _read_pid(master)
    misses = 0
    while not over.wait(LOST_PERIOD if misses else PERIOD):
        pid = _read_pid(master)
        if pid is None:
            misses += 1
            if misses == MISSES:
                report(MasterLost())
            continue
        if known is not None and pid != known:
            report(MasterReplaced())
        elif misses >= MISSES:
            report(MasterReturned())
        known, misses = pid, 0


def _read_pid(master: Master) -> int | None:
    try:
        return int(master.call("getPid"))
    except (Unanswered, CallRefused, ValueError, TypeError):
        return None
