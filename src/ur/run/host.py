"""The process host: a small program of its own that owns every process of a run, so that none outlives the run.

The supervisor starts it first and sends it what to start and what to signal; it reports what happened. It is the parent
of all processes, and a *subreaper*: what a node leaves behind (a double fork, a daemon in a session of its own)
becomes its child, so that nothing can hide. Either one of the pair may be killed with SIGKILL:

- the supervisor dies: the socket closes, the host ends everything within a second and exits;
- the host dies: nodes get SIGKILL as parent-death signal, and their orphans become children of the supervisor, which is
  a subreaper too and kills them.

The host is in a process group of its own and has a command line of its own, so that neither `kill -9 -GROUP` nor
`pkill -9 -f 'ur launch'` takes both at once. It stays in the terminal's session: a node that owns the terminal has to
be started there.

Runs with `python -I -S`: nothing but the standard library, for a start in a few milliseconds.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import marshal
import os
import select
import signal
import socket
import sys
import termios
import time
from typing import Any

PR_SET_PDEATHSIG = 1  # linux/prctl.h
PR_SET_NAME = 15
PR_SET_CHILD_SUBREAPER = 36

SESSION = "session"  # where a process is started: in a session of its own, with no terminal,
GROUP = "group"  # in the terminal's session,
FOREGROUND = "foreground"  # or there as the group that owns the terminal on its standard input

RECORD = 4096  # bytes that a pipe takes in one piece, pipe(7)
POLITE = 0.7  # s that processes get to end after the supervisor died
RESET_TERMINAL = (
    b"\x1b[?1049l"  # leave the alternate screen
    b"\x1b[<u"  # leave the kitty keyboard protocol
    b"\x1b[?1000l\x1b[?1002l\x1b[?1003l\x1b[?1006l\x1b[?1015l"  # no mouse reports
    b"\x1b[?1004l\x1b[?2004l"  # no focus reports, no bracketed paste
    b"\x1b[0m\x1b[?25h\r"  # plain text, cursor shown
)
_IGNORED = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGTSTP", "SIGTTIN", "SIGTTOU", "SIGPIPE")


def main(descriptor: int) -> int:
    """Serve the supervisor behind a socket until it closes."""
    os.set_inheritable(descriptor, False)  # a node that held our end would hide our death
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    libc.prctl(PR_SET_NAME, b"ur-host", 0, 0, 0)
    # Blocked as well as ignored: a signal that reaches a new process before it is ready is kept for it, signal(7).
    signal.pthread_sigmask(signal.SIG_BLOCK, [getattr(signal, name) for name in _IGNORED])
    for name in _IGNORED:
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    host = _Host(socket.socket(fileno=descriptor), libc)
    try:
        host.serve()
    except (EOFError, ConnectionError):
        pass
    finally:
        host.end_all()
    return 0


class _Host:
    """The processes that were started, by the name the supervisor gave them."""

    def __init__(self, link: socket.socket, libc: ctypes.CDLL) -> None:
        self._link = link
        self._libc = libc
        self._names: dict[int, str] = {}  # by process id
        self._pids: dict[str, int] = {}
        self._environment: dict[str, str] = {}
        self._failed: dict[str, tuple[int, str]] = {}
        self._sweeping = 0
        self._terminal: tuple[str, int, list[Any]] | None = None
        self._failures, self._failure_end = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._wake, wake_end = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        signal.set_wakeup_fd(wake_end, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)

    def serve(self) -> None:
        """Until the link closes (EOFError)."""
        poll = select.poll()
        for descriptor in (self._link.fileno(), self._wake):
            poll.register(descriptor, select.POLLIN)
        while True:
            for descriptor, _ in poll.poll():
                if descriptor == self._wake:
                    _drain(self._wake)
                    self._reap()
                else:
                    self._obey(*receive(self._link))

    def _obey(self, message: tuple[Any, ...], descriptors: list[int]) -> None:
        kind, *rest = message
        if kind == "start":
            self._start(rest[0], rest[1], rest[2], rest[3], rest[4], descriptors)
        elif kind == "signal":
            name, signum = rest
            pid = self._pids.get(name)
            if pid is not None:
                _signal_group(pid, signum)
        elif kind == "sweep":
            self._sweeping = int(rest[0])
            _signal_all(self._sweeping)
            self._reap()
        elif kind == "environment":
            self._environment = rest[0]
        for descriptor in descriptors:
            os.close(descriptor)

    def _start(
        self, name: str, argv: list[str], cwd: str, changes: dict[str, str | None], place: str, stdio: list[int]
    ) -> None:
        environment = dict(self._environment)
        for key, value in changes.items():
            if value is None:
                environment.pop(key, None)
            else:
                environment[key] = value
        if place == FOREGROUND and self._terminal is None:
            kept = fcntl.fcntl(stdio[0], fcntl.F_DUPFD_CLOEXEC, 10)
            self._terminal = (name, kept, termios.tcgetattr(kept))
        parent = os.getpid()
        try:
            pid = os.fork()
        except OSError as problem:
            self._send("failed", name, problem.errno, "")
            return
        if pid == 0:
            self._become(name, argv, cwd, environment, place, stdio, parent)
        self._names[pid] = name
        self._pids[name] = pid
        self._send("started", name, pid)

    def _become(
        self,
        name: str,
        argv: list[str],
        cwd: str,
        environment: dict[str, str],
        place: str,
        stdio: list[int],
        parent: int,
    ) -> None:
        """In the new process: turn into the node, or say why not and exit with 127."""
        problem = argv[0]
        try:
            if place == SESSION:
                os.setsid()
            else:
                os.setpgid(0, 0)
            if place == FOREGROUND:
                take_foreground(stdio[0], os.getpid())
            self._libc.prctl(PR_SET_PDEATHSIG, int(signal.SIGKILL), 0, 0, 0)
            if os.getppid() != parent:
                os._exit(127)
            for number, descriptor in enumerate(stdio[:3]):
                os.dup2(descriptor, number)
            signal.set_wakeup_fd(-1)
            for signal_name in (*_IGNORED, "SIGCHLD", "SIGXFSZ"):
                signal.signal(getattr(signal, signal_name), signal.SIG_DFL)
            signal.pthread_sigmask(signal.SIG_SETMASK, [])
            problem = cwd
            os.chdir(cwd)
            problem = argv[0]
            os.execvpe(argv[0], argv, environment)  # noqa: S606 - what a process host is for
        except OSError as failure:
            os.write(self._failure_end, marshal.dumps((name, failure.errno or 0, problem)).ljust(RECORD))
        finally:
            os._exit(127)

    def _reap(self) -> None:
        while True:
            try:
                pid, status = os.waitpid(-1, os.WNOHANG | os.WUNTRACED)
            except ChildProcessError:
                if self._sweeping:
                    self._sweeping = 0
                    self._send("empty")
                return
            if pid == 0:
                break
            if os.WIFSTOPPED(status):
                if pid in self._names:
                    self._send("stopped", self._names[pid])
                continue
            name = self._names.pop(pid, None)
            if name is None:
                continue
            self._pids.pop(name, None)
            if self._terminal is not None and self._terminal[0] == name:
                os.close(self._terminal[1])
                self._terminal = None  # the supervisor puts it back
            failure = self._failure(name) if os.WIFEXITED(status) and os.WEXITSTATUS(status) == 127 else None
            if failure is not None:
                self._send("failed", name, *failure)
            elif os.WIFSIGNALED(status):
                self._send("exited", name, None, os.WTERMSIG(status))
            else:
                self._send("exited", name, os.WEXITSTATUS(status), None)
        if self._sweeping == signal.SIGKILL:
            _signal_all(self._sweeping)  # what the last victims left behind

    def _failure(self, name: str) -> tuple[int, str] | None:
        """Why a process never became its program; None when it did."""
        try:
            while record := os.read(self._failures, RECORD):
                failed, number, what = marshal.loads(record)  # noqa: S302 - written by ourselves
                self._failed[failed] = (number, what)
        except BlockingIOError:
            pass
        return self._failed.pop(name, None)

    def _send(self, *message: Any) -> None:
        send(self._link, message)

    def end_all(self) -> None:
        """The supervisor is gone: end everything, politely first, and leave the terminal usable."""
        limit = time.monotonic() + POLITE
        _signal_all(signal.SIGINT)
        while time.monotonic() < limit and _wait_one():
            pass
        limit = time.monotonic() + 3.0
        while time.monotonic() < limit and _signal_all(signal.SIGKILL):
            _wait_one()
        if self._terminal is not None:
            restore_terminal(*self._terminal[1:], reset=True)


def _wait_one() -> bool:
    """Reap for up to 20 ms. False when there is no child left."""
    try:
        if os.waitpid(-1, os.WNOHANG)[0] == 0:
            select.select([], [], [], 0.02)
    except ChildProcessError:
        return False
    return True


def _signal_group(pid: int, signum: int) -> None:
    try:
        os.killpg(pid, signum)
    except ProcessLookupError:
        # Its first instruction is to become the leader of a group; it may not have come that far.
        try:
            os.kill(pid, signum)
        except ProcessLookupError:
            return
    except PermissionError:
        return
    if signum in (signal.SIGTERM, signal.SIGINT):
        try:
            os.killpg(pid, signal.SIGCONT)  # a stopped process hears nothing
        except OSError:
            return


def _signal_all(signum: int) -> int:
    """Signal every descendant of this process. Returns how many there are."""
    descendants = list_descendants(os.getpid())
    for pid in descendants:
        try:
            os.kill(pid, signum)
            if signum != signal.SIGKILL:
                os.kill(pid, signal.SIGCONT)
        except OSError:  # noqa: PERF203 - one that has just ended must not save the others
            continue
    return len(descendants)


def list_descendants(root: int) -> list[int]:
    """The processes below a process, however deep, without those that have ended and wait to be reaped."""
    children: dict[int, list[int]] = {}
    ended = set()
    for entry in os.listdir("/proc"):  # noqa: PTH208 - pathlib doubles the start-up time here
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", "rb") as file:  # noqa: PTH123 - pathlib doubles the start-up time here
                state, parent = file.read().rpartition(b")")[2].split()[:2]
        except OSError:
            continue
        children.setdefault(int(parent), []).append(int(entry))
        if state in (b"Z", b"X"):
            ended.add(int(entry))
    found = []
    queue = list(children.get(root, ()))
    while queue:
        pid = queue.pop()
        found.append(pid)
        queue.extend(children.get(pid, ()))
    return [pid for pid in found if pid not in ended]


def take_foreground(descriptor: int, group: int) -> None:
    """Make a process group the terminal's foreground group, where that is ours to decide."""
    try:
        os.tcsetpgrp(descriptor, group)
    except OSError as problem:
        if problem.errno not in (errno.ENOTTY, errno.EPERM, errno.EIO, errno.EINVAL, errno.EBADF):
            raise


def restore_terminal(descriptor: int, attributes: list[Any], *, reset: bool) -> None:
    """Put the terminal's modes back; with `reset` also what a program that was killed left on the screen."""
    try:
        if reset:
            os.write(descriptor, RESET_TERMINAL)
        termios.tcsetattr(descriptor, termios.TCSADRAIN, attributes)
    except (OSError, termios.error):
        return


def send(link: socket.socket, message: tuple[Any, ...], descriptors: tuple[int, ...] = ()) -> None:
    """Send one message, with open files. Both ends run the same Python, so `marshal` is a safe language."""
    data = marshal.dumps(message)
    head = len(data).to_bytes(4, "little")
    if descriptors:
        socket.send_fds(link, [head], descriptors)
        link.sendall(data)
    else:
        link.sendall(head + data)


def receive(link: socket.socket) -> tuple[tuple[Any, ...], list[int]]:
    """Receive one message. EOFError when the other end is gone."""
    head, descriptors, _, _ = socket.recv_fds(link, 4, 3, socket.MSG_CMSG_CLOEXEC)
    while len(head) < 4:
        more = link.recv(4 - len(head)) if head else b""
        if not more:
            raise EOFError
        head += more
    size = int.from_bytes(head, "little")
    data = bytearray()
    while len(data) < size:
        part = link.recv(size - len(data))
        if not part:
            raise EOFError
        data += part
    return marshal.loads(data), list(descriptors)  # noqa: S302 - from our own other half


def _drain(descriptor: int) -> None:
    try:
        while os.read(descriptor, 4096):
            pass
    except BlockingIOError:
        return


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1])))
