"""Monitor of a master that another process runs."""

import socket
import threading
import time
from collections.abc import Callable
from threading import Event as Flag

from ur.robot.addresses import AddressCache
from ur.run.master.client import Master
from ur.run.master.xml_rpc import CallRefused, Unanswered
from ur.run.paths import is_local_address
from ur.run.supervisor.events import (
    Event,
    LinkLost,
    LinkRestored,
    MasterLost,
    MasterReplaced,
    MasterReturned,
    RobotMasterLost,
)
from ur.source.data_classes import dataclass, replace

LINK_PERIOD = 0.3  # s between two polls
LOST_AFTER = 1.0  # s without an answer from the robot, after which the link is lost
ENDED_AFTER = 3.0  # s of answers without a master, after which the master counts as ended
LONGEST_QUESTION, SHORTEST_QUESTION = 0.5, 0.2  # s for an answer


@dataclass(frozen=True, slots=True)
class MasterState:
    """An answer of the robot: the process id and run id of its master. `pid` is None if no master runs on the robot."""

    pid: int | None
    run_id: str = ""


BUSY = MasterState(-1)  # the robot accepts connections, but its master is slow


@dataclass(frozen=True, slots=True)
class LinkState:
    """The link: `last` is the time of the last answer, `master` is its content; `refused` since when no master runs."""

    last: float
    lost: bool = False
    master: MasterState | None = None
    refused: float | None = None


def step_link(state: LinkState, answer: MasterState | None, now: float) -> tuple[LinkState, tuple[Event, ...]]:
    """Return the state and the events that follow from an answer, or from none (None)."""
    if answer is None:
        silent = now - state.last
        if silent < LOST_AFTER:
            return state, ()
        return replace(state, lost=True, refused=None), (LinkLost(silent),)
    events: list[Event] = [LinkRestored(now - state.last)] if state.lost else []
    state = replace(state, last=now, lost=False)
    if answer is BUSY:
        return state, tuple(events)
    if answer.pid is None:
        since = now if state.refused is None else state.refused
        if now - since >= ENDED_AFTER:
            events.append(RobotMasterLost(now - since))
        return replace(state, refused=since), tuple(events)
    if state.master is not None and is_another(state.master, answer):
        events.append(MasterReplaced())
    elif state.refused is not None and now - state.refused >= ENDED_AFTER:
        events.append(MasterReturned())
    return replace(state, master=answer, refused=None), tuple(events)


def is_another(before: MasterState, now: MasterState) -> bool:
    """Return whether another master answers: its process id or run id differs, as after a restart."""
    return before.pid != now.pid or bool(before.run_id and now.run_id and before.run_id != now.run_id)


def choose_limit(state: LinkState, now: float) -> float:
    """Choose the time (s) to wait for the next answer, so that a loss is detected in time."""
    if state.lost:
        return LONGEST_QUESTION
    return min(LONGEST_QUESTION, max(SHORTEST_QUESTION, state.last + LOST_AFTER - now))


def watch_link(master: Master, report: Callable[[Event], None], over: Flag) -> None:
    """Poll a robot and its master until `over`, and report changes."""
    addresses = AddressCache()
    state = LinkState(time.monotonic())
    answered = True
    while not over.wait(LINK_PERIOD if answered else 0.0):
        answer, now = _ask(master, addresses, choose_limit(state, time.monotonic()), over)
        answered = answer is not None
        state, events = step_link(state, answer, now)
        for event in events:
            report(event)


def _ask(master: Master, addresses: AddressCache, limit: float, over: Flag) -> tuple[MasterState | None, float]:
    """Return the robot's answer within a limit (s), and the time when it was reached or the attempt was abandoned."""
    end = time.monotonic() + limit
    try:
        asked = replace(master, host=addresses.find(master.host), timeout=LONGEST_QUESTION)
        socket.create_connection((asked.host, asked.port), limit).close()
    except (ConnectionRefusedError, ConnectionResetError):
        return MasterState(None), time.monotonic()
    except OSError:
        over.wait(max(0.0, end - time.monotonic()))  # an unreachable network is reported at once
        return None, time.monotonic()
    alive = time.monotonic()
    try:
        pid, run_id = asked.call_many([("getPid", ()), ("getParam", ("/run_id",))])
        return MasterState(int(pid), run_id if isinstance(run_id, str) else ""), alive
    except Unanswered:
        return BUSY, alive
    except (CallRefused, ValueError, TypeError):
        return MasterState(None), alive  # a server answers that is not a master


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
