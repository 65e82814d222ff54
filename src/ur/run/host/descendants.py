"""Find, signal and reap the processes below this one."""

import ctypes
import os
import select
import time
from collections.abc import Callable

from ur.run.host.signals import signal

PR_SET_PDEATHSIG = 1  # linux/prctl.h
PR_SET_NAME = 15
PR_SET_CHILD_SUBREAPER = 36

RECORDING_GUARD = b"ur-black-box"
"""The name of processes that only write a file: those that guard the memory of a black box."""

MOTOR_GUARD = b"ur-motor-guard"
"""The name of processes that stop the motors of a board and end, once the driver of the board has ended."""

DRIVER = b"ur-motor-driver"
"""The name of drivers that stop their motors when the host is killed; guard.sh spares both names for a moment."""


def inherit_orphans() -> None:
    """Make this process the parent of descendants whose own parent ends: a subreaper, prctl(2)."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def name_process(name: bytes) -> None:
    """Set the name of this process in `ps` and `top`; 15 bytes at most."""
    ctypes.CDLL(None).prctl(PR_SET_NAME, name, 0, 0, 0)


def become_driver() -> Callable[[], bool]:
    """Let this process stop its motors when the host is killed: it gets SIGTERM then, not SIGKILL. On the main thread.

    The guard of the motors may have been killed with the host. Returns a function that tells whether it was.
    """
    name_process(DRIVER)
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGTERM, 0, 0, 0)
    host = os.getppid()
    return lambda: os.getppid() != host


def list_descendants(root: int, spared: tuple[bytes, ...] = ()) -> list[int]:
    """Return all descendants of a process, without those of some names, and those that wait to be reaped."""
    children: dict[int, list[int]] = {}
    left_out = set()
    for entry in os.listdir("/proc"):  # noqa: PTH208 - pathlib doubles the start-up time here
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", "rb") as file:  # noqa: PTH123 - pathlib doubles the start-up time here
                head, _, tail = file.read().rpartition(b")")
        except OSError:
            continue
        state, parent = tail.split()[:2]
        children.setdefault(int(parent), []).append(int(entry))
        if state in (b"Z", b"X") or head.partition(b"(")[2] in spared:
            left_out.add(int(entry))
    found = []
    queue = list(children.get(root, ()))
    while queue:
        pid = queue.pop()
        found.append(pid)
        queue.extend(children.get(pid, ()))
    return [pid for pid in found if pid not in left_out]


def signal_descendants(signum: int, spared: tuple[bytes, ...] = (MOTOR_GUARD,)) -> int:
    """Signal every process below this one, except those of some names; stopped ones are continued to receive it.

    Returns their number.
    """
    descendants = list_descendants(os.getpid(), spared)
    for pid in descendants:
        try:
            os.kill(pid, signum)
            if signum != signal.SIGKILL:
                os.kill(pid, signal.SIGCONT)
            else:
                _end_debugger(pid)
        except OSError:  # noqa: PERF203 - one that has just ended must not save the others
            continue
    return len(descendants)


def signal_group(pid: int, signum: int) -> None:
    """Signal the process group of a child process, if it still exists."""
    try:
        os.killpg(pid, signum)
    except ProcessLookupError:
        # Its first instruction makes it the leader of a group; it may not have been executed yet.
        try:
            os.kill(pid, signum)
        except ProcessLookupError:
            return
    except PermissionError:
        return
    if signum == signal.SIGKILL:
        _end_debugger(pid)
    if signum in (signal.SIGTERM, signal.SIGINT):
        try:
            os.killpg(pid, signal.SIGCONT)  # a stopped process handles no signals
        except OSError:
            return


def _end_debugger(pid: int) -> None:
    """End a gdb that holds a killed process: the process stays, and its parent waits, until gdb lets go."""
    try:
        with open(f"/proc/{pid}/status", "rb") as file:  # noqa: PTH123 - pathlib takes time to import
            tracer = int(file.read().partition(b"TracerPid:")[2].split()[0])
        with open(f"/proc/{tracer}/comm", "rb") as file:  # noqa: PTH123 - likewise
            if file.read() == b"gdb\n":
                os.kill(tracer, signal.SIGTERM)
    except (OSError, IndexError, ValueError):
        return  # it has ended, or the debugger is another user's


def kill_descendants(limit: float, spared: tuple[bytes, ...] = (MOTOR_GUARD,)) -> None:
    """Kill and reap every process below this one, within a time limit (s); those of some names are only waited for."""
    end = time.monotonic() + limit
    while reap_one(0.0) and time.monotonic() < end:
        signal_descendants(signal.SIGKILL, spared)
        reap_one(0.01)


def reap_one(patience: float) -> bool:
    """Reap a child that has ended, or wait up to `patience` s. False if there is no child left."""
    try:
        if os.waitpid(-1, os.WNOHANG)[0] == 0:
            select.select([], [], [], patience)
    except ChildProcessError:
        return False
    return True
