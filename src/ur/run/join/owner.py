"""Runs that own nodes which other runs use: wait for their start, monitor their end, list joined runs."""

import os
import select
import threading
import time
from collections.abc import Callable, Iterable, Mapping

from ur.run.clients.client import RunUnreachable, connect_run
from ur.run.clients.protocol import RunEnded, RunStopping
from ur.run.join.decision import read_claims
from ur.run.master.client import Master, parse_master_uri
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.middleware.facts import read_facts
from ur.run.record.registry import RunEntry, list_runs, read_computer
from ur.run.supervisor.events import Event, OwnerEnded
from ur.source.run_users import read_birth
from ur.system.ros import find_facts, read_domain

START_SECONDS = 60.0
_PATIENCE = 2.0  # s of waiting, after which the wait is reported
_PERIOD = 0.05  # s


def await_owner(entry: RunEntry, report: Callable[[str], None]) -> bool:
    """Wait until a run has set its parameters, after which its nodes start. False if it ends, or takes too long."""
    has_begun = _ask_master(entry.master_uri)
    began = time.monotonic()
    reported = False
    while read_birth(entry.pid) == entry.born and time.monotonic() < began + START_SECONDS:
        if has_begun():
            return True
        if not reported and time.monotonic() > began + _PATIENCE:
            report(f"waiting for {entry.run} to start")
            reported = True
        time.sleep(_PERIOD)
    return False


def _ask_master(address: str) -> Callable[[], bool]:
    """Return a function that tests whether the runs at this address have set their parameters."""
    domain = read_domain(address)
    if domain is not None:
        path = find_facts(os.environ, domain)
        return lambda: bool(read_facts(path).get("run_id"))
    known = parse_master_uri(address)
    master = Master(known.uri, known.host, known.port, 1.0)

    def ask() -> bool:
        try:
            return master.get_run_id() is not None
        except (Unanswered, CallRefused):
            return False

    return ask


def list_joined(run: str, environment: Mapping[str, str], uid: int) -> list[str]:
    """Return the ids of the runs of a user on this computer that have joined a run."""
    runs = list_runs(environment, uid, read_computer())
    return [each.run for each in runs if run in read_claims(each.folder).joined]


def follow_owners(owners: Iterable[RunEntry], report: Callable[[Event], None], over: threading.Event) -> None:
    """Report the end of each of these runs, each from a separate thread, until `over`."""
    for entry in owners:
        threading.Thread(target=_follow, args=(entry, report, over), daemon=True).start()


def describe_joined(runs: Iterable[str]) -> str:
    """Describe the runs that end together with the one that they have joined; '' if there is none."""
    names = list(runs)
    if not names:
        return ""
    return f"{', '.join(names)} had joined it and {'ends' if len(names) == 1 else 'end'}, too"


def _follow(entry: RunEntry, report: Callable[[Event], None], over: threading.Event) -> None:
    cause = _wait_end(entry, over)
    if not over.is_set():
        report(OwnerEnded(f"{entry.run}, which this run had joined, {cause}"))


def _wait_end(entry: RunEntry, over: threading.Event) -> str:
    try:
        with connect_run(entry.folder) as client:
            while not over.is_set():
                select.select([client], [], [], 1.0)
                events = client.receive()
                for event in events or ():
                    if isinstance(event, RunStopping):
                        return f"ends: {event.cause}" if event.cause else "ends"
                    if isinstance(event, RunEnded):
                        return "has ended"
                if events is None:
                    break
    except RunUnreachable:
        return "has ended"
    except OSError:
        pass
    return "was killed"
