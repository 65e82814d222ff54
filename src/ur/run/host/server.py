"""Server of the process host: executes requests of the supervisor and reports events."""

from __future__ import annotations

import fcntl
import gc
import os
import select
import termios
import time
from _socket import MSG_DONTWAIT
from _socket import socket as Socket  # noqa: N812 - a class, named as classes are

from ur.run.host.descendants import (
    MOTOR_GUARD,
    RECORDING_GUARD,
    inherit_orphans,
    kill_descendants,
    name_process,
    reap_one,
    signal_descendants,
    signal_group,
)
from ur.run.host.fork import NOT_EXECUTED, ProcessCreator
from ur.run.host.forks import NodeForks
from ur.run.host.protocol import FOREGROUND, pack, receive
from ur.run.host.signals import IGNORED, signal
from ur.run.host.terminal import restore_terminal

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

MOST_WAITING = 200  # processes that are created before any of them runs; each takes half a MB meanwhile
INTERRUPT_SECONDS = 0.7  # s that processes get to end after the supervisor died
RECORDING_SECONDS = 10.0  # s more for the guard of a black box, which writes what happened, and for those of motors
KILL_SECONDS = 3.0  # s that they get after SIGKILL


def serve(descriptor: int) -> None:
    """Serve the supervisor behind a socket until it closes, then end all processes."""
    os.set_inheritable(descriptor, False)  # a node with a copy of this descriptor would hide the end of this process
    inherit_orphans()
    name_process(b"ur-host")
    # Blocked as well as ignored: a signal that reaches a new process before it is ready is kept for it, signal(7).
    signal.pthread_sigmask(signal.SIG_BLOCK, IGNORED)
    for signum in IGNORED:
        signal.signal(signum, signal.SIG_IGN)
    gc.freeze()  # memory that a new process does not modify is not copied for it
    host = _Host(Socket(fileno=descriptor))
    try:
        host.serve()
    except (EOFError, ConnectionError):
        pass
    finally:
        host.end_all()


class _Host:
    """The started processes, by the names that the supervisor gave them."""

    def __init__(self, link: Socket) -> None:
        self._link = link
        # The supervisor may be busy sending; if both waited for the other to receive, both would block forever.
        self._unsent = bytearray()
        self._creator = ProcessCreator()
        self._forks = NodeForks()
        self._names: dict[int, str] = {}  # by process id
        self._pids: dict[str, int] = {}
        self._environment: dict[str, str] = {}
        self._sweeping = 0
        self._terminal: tuple[str, int, list[Any]] | None = None  # who owns it, an open file on it, its modes before
        self._wake, wake_end = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        signal.set_wakeup_fd(wake_end, warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)

    def serve(self) -> None:
        """Handle requests and ended processes until the link closes (EOFError)."""
        link = self._link.fileno()
        poll = select.poll()
        poll.register(self._wake, select.POLLIN)
        while True:
            waiting = self._creator.waiting
            poll.register(link, select.POLLIN | (select.POLLOUT if self._unsent and not waiting else 0))
            if (forks := self._forks.fileno()) >= 0:
                poll.register(forks, select.POLLIN)
            ready = dict(poll.poll(0 if waiting else None))
            readable = ready.get(link, 0) & ~select.POLLOUT
            if waiting and (not readable or waiting >= MOST_WAITING):
                self._creator.release()
            if self._wake in ready:
                _drain(self._wake)
                self._reap()
            if forks in ready:
                self._adopt_forked()
            if readable:
                self._handle_request(*receive(self._link))
            if forks >= 0 and self._forks.fileno() < 0:
                poll.unregister(forks)
            if not self._creator.waiting:
                self._flush()

    def end_all(self) -> None:
        """End all processes after the supervisor has ended: SIGINT first, then SIGKILL. Restores the terminal."""
        limit = time.monotonic() + INTERRUPT_SECONDS
        if reap_one(0.0):
            from ur.recordings.black_boxes import notify_black_boxes  # only where the supervisor was killed

            notify_black_boxes(self._environment, "the supervisor of the run was killed")
            signal_descendants(signal.SIGINT)
        while time.monotonic() < limit and reap_one(0.02):
            pass
        kill_descendants(RECORDING_SECONDS, (RECORDING_GUARD, MOTOR_GUARD))
        kill_descendants(KILL_SECONDS, ())
        if self._terminal is not None:
            restore_terminal(*self._terminal[1:], reset=True)

    def _handle_request(self, message: tuple[Any, ...], descriptors: list[int]) -> None:
        if message[0] != "start":
            self._creator.release()
        match message:
            case ("start", name, argv, cwd, changes, session_mode, words):
                start = (name, argv, cwd, changes, session_mode, descriptors)
                if not words or not self._forks.request(start, words):
                    self._start(*start)
            case ("signal", name, signum):
                if name in self._forks.waiting:
                    self._execute_waiting()  # it ends at once, while the server may import for long
                pid = self._pids.get(name)
                if pid is not None:
                    signal_group(pid, signum)
            case ("sweep", signum):
                self._sweep(signum)
            case ("begin", environment, keep_terminal, server):
                self._environment = environment
                if keep_terminal:
                    os.setpgid(0, 0)
                else:
                    os.setsid()
                if server:
                    self._forks.begin(self._creator, server, environment)
        for descriptor in descriptors:
            os.close(descriptor)

    def _sweep(self, signum: int) -> None:
        self._sweeping = signum
        self._forks.end()
        self._reap()
        if self._sweeping:  # else nothing is below this process, which would be looked for among all processes
            signal_descendants(signum)

    def _start(
        self, name: str, argv: list[str], cwd: str, changes: dict[str, str | None], session_mode: str, stdio: list[int]
    ) -> None:
        merged = {**self._environment, **changes}
        environment = {key: value for key, value in merged.items() if value is not None}
        if session_mode == FOREGROUND and self._terminal is None:
            kept = fcntl.fcntl(stdio[0], fcntl.F_DUPFD_CLOEXEC, 10)
            self._terminal = (name, kept, termios.tcgetattr(kept))
        try:
            pid = self._creator.create(name, argv, cwd, environment, session_mode, stdio)
        except OSError as problem:
            self._send("failed", name, problem.errno, "")
            return
        self._note_started(name, pid)

    def _note_started(self, name: str, pid: int) -> None:
        self._names[pid] = name
        self._pids[name] = pid
        self._send("started", name, pid)

    def _adopt_forked(self) -> None:
        forked = self._forks.receive()
        if forked is None:
            self._execute_waiting()
            return
        name, pid, gate = forked
        self._note_started(name, pid)
        try:
            os.write(gate, b"1")
        except BrokenPipeError:  # it was killed before this process knew it
            del self._names[pid], self._pids[name]
            self._send("exited", name, None, signal.SIGKILL)
        os.close(gate)

    def _execute_waiting(self) -> None:
        for start in self._forks.end():
            self._start(*start)
            for descriptor in start[-1]:
                os.close(descriptor)

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
            if not os.WIFSTOPPED(status):
                self._report_exit(pid, status)
            elif pid in self._names:
                self._send("stopped", self._names[pid])
        if self._sweeping == signal.SIGKILL:
            signal_descendants(self._sweeping)  # the children of those that have just been killed

    def _report_exit(self, pid: int, status: int) -> None:
        name = self._names.pop(pid, None)
        if name is None:
            return  # an orphan
        self._pids.pop(name, None)
        if self._terminal is not None and self._terminal[0] == name:
            os.close(self._terminal[1])
            self._terminal = None  # the supervisor puts it back
        if os.WIFSIGNALED(status):
            self._send("exited", name, None, os.WTERMSIG(status))
            return
        code = os.WEXITSTATUS(status)
        failure = self._creator.find_failure(name) if code == NOT_EXECUTED else None
        if failure is not None:
            self._send("failed", name, *failure)
        else:
            self._send("exited", name, code, None)

    def _send(self, *message: object) -> None:
        self._unsent += pack(message)

    def _flush(self) -> None:
        """Send pending messages to the supervisor without blocking."""
        while self._unsent:
            try:
                del self._unsent[: self._link.send(self._unsent, MSG_DONTWAIT)]
            except BlockingIOError:  # noqa: PERF203 - the end of the loop
                return


def _drain(descriptor: int) -> None:
    try:
        while os.read(descriptor, 4096):
            pass
    except BlockingIOError:
        return
