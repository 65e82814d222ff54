"""How a run appears to others on this computer: its entry in the registry, and who may watch it."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Mapping
from typing import TYPE_CHECKING

from ur.launchfile.plan.model import NodeSpec, Plan
from ur.run.console import Console
from ur.run.master import Master
from ur.run.options import Options
from ur.run.registry import RunEntry, make_run_name, read_birth, register_run
from ur.run.run import WatchPlan
from ur.source.diagnostic import UserError, error

if TYPE_CHECKING:
    from ur.run.events import RunStarted

Registered = tuple[RunEntry, socket.socket | None]


def register(
    plan: Plan, master: Master, folder: str, environment: Mapping[str, str], console: Console, *, detached: bool
) -> Registered:
    """Enter a run in the registry; the socket is None where that cannot be done. Raises UserError if it is detached."""
    pid = os.getpid()
    title, name = make_run_name(plan.files, pid)
    entry = RunEntry(
        name, pid, read_birth(pid) or 0, title, master.uri, folder, time.time(), detached, socket.gethostname()
    )
    made = register_run(entry, environment, os.getuid())
    if made is not None:
        return made
    if detached:
        raise UserError(
            error(
                "no private folder for the run can be made, so nobody could reach it once it is detached",
                rule="bad-state-folder",
                help="XDG_STATE_HOME chooses another place",
            )
        )
    console.warn("this run is not listed by 'ur ps': no private folder for it can be made (XDG_STATE_HOME)")
    return entry, None


def plan_watch(here: Registered, nodes: tuple[NodeSpec, ...], options: Options) -> WatchPlan:
    """Who may watch a run that was registered."""
    entry, listener = here
    call = options.call_started

    def describe() -> RunStarted:
        from ur.run.events import RunStarted  # only for those who watch

        return RunStarted(
            run=entry.run,
            pid=entry.pid,
            title=entry.title,
            master_uri=entry.master_uri,
            log_folder=entry.log_folder,
            started=entry.started,
            detached=entry.detached,
            terminal=next((node.full_name for node in nodes if node.terminal), ""),
        )

    return WatchPlan(
        describe=describe,
        listener=listener,
        viewer=options.viewer,
        events=options.events,
        unattended=call is not None,
        call_started=None if call is None else lambda: call(entry),
    )
