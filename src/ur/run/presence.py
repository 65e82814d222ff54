"""Registration of a run on this computer: its entry in the registry, and the socket for clients."""

from __future__ import annotations

import os
import socket
import sys
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.recordings.black_boxes import notify_black_boxes
from ur.run.options import RunOptions
from ur.run.output.console import Console
from ur.run.record.computer import read_computer
from ur.run.record.entry import RunEntry, runs_folders
from ur.run.record.registry import make_run_name, register_run
from ur.run.run import RunClients
from ur.source.diagnostic import UserError, error
from ur.source.run_users import note_user, read_birth

if TYPE_CHECKING:
    from ur.run.clients.protocol import RunStarted

Registered = tuple[RunEntry, socket.socket | None]


def register(
    plan: Plan, address: str, folder: str, environment: Mapping[str, str], console: Console, *, detached: bool
) -> Registered:
    """Enter a run in the registry. The socket is None if that fails, which raises UserError for a detached run."""
    pid = os.getpid()
    title, name = make_run_name(plan.files, pid)
    computer = read_computer()
    entry = RunEntry(
        name,
        pid,
        read_birth(pid) or 0,
        title,
        address,
        folder,
        time.time(),
        detached,
        computer.host,
        machine=computer.machine,
        boot=computer.boot,
    )
    made = register_run(entry, environment, os.getuid())
    if made is not None:
        return made
    folders = " or ".join(runs_folders(environment, os.getuid()))
    if detached:
        raise UserError(
            error(
                f"no private folder for the run can be made in {folders}, so it cannot be reached once detached",
                rule="bad-state-folder",
                help="they belong to another user or cannot be written: XDG_STATE_HOME chooses another place",
            )
        )
    console.warn(
        f"this run is not listed by 'ur ps': no private folder for it can be made in {folders}; "
        "XDG_STATE_HOME chooses another place"
    )
    return entry, None


def claim(entry: RunEntry, nodes: Sequence[NodeSpec], plan: Plan, options: RunOptions) -> None:
    """Publish the nodes that a run starts and the runs it has joined to other launches, and to the joined runs."""
    if entry.folder:
        from ur.run.join.claims import make_claims, write_claims

        with suppress(OSError):  # a full disk: other launches still find the nodes while they run
            write_claims(entry.folder, make_claims(nodes, plan.params, (each.run for each in options.owners)))
    from ur.run.record.plan_record import plan_path, write_plan

    with suppress(OSError):  # a report is then without the plan
        write_plan(plan_path(entry.log_folder, entry.run), plan, nodes, sys.argv)
    for owner in options.owners:
        with suppress(OSError):  # it is ending, and this run ends with it
            note_user(owner.folder, entry.run)
    if options.call_registered is not None:
        options.call_registered()


def list_joined_runs(entry: RunEntry) -> Sequence[str]:
    """Return the ids of the runs that have joined a run."""
    from ur.run.join.owner import list_joined

    return list_joined(entry.run, os.environ, os.getuid())


def plan_clients(
    here: Registered, nodes: tuple[NodeSpec, ...], options: RunOptions, environment: Mapping[str, str]
) -> RunClients:
    """Plan the monitoring of a registered run: its socket, viewer, event file and end record.

    `environment` is that of the nodes, of which a black box takes events.
    """
    entry, listener = here
    call = options.call_started

    def describe() -> RunStarted:
        from ur.run.clients.protocol import RunStarted  # imported late: only for clients

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

    def record(exit_code: int, cause: str, lines: Sequence[str], logs: dict[str, str]) -> None:
        from ur.run.record.ended import EndedRun, write_ended  # only at the end

        ended = EndedRun(entry, time.time(), exit_code, cause, tuple(lines), logs)
        write_ended(ended, os.environ, os.getuid())

    return RunClients(
        describe=describe,
        record_end=record if entry.folder else None,
        report_event=partial(notify_black_boxes, environment),
        listener=listener,
        viewer=options.viewer,
        events=options.events,
        unattended=call is not None,
        call_started=None if call is None else lambda: call(entry),
    )
