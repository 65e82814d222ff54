"""Creation of a process: the steps between fork and exec."""

from __future__ import annotations

import ctypes
import marshal
import os

from ur.run.host.descendants import PR_SET_PDEATHSIG
from ur.run.host.protocol import FOREGROUND, SESSION
from ur.run.host.signals import IGNORED, signal
from ur.run.host.terminal import set_foreground

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

RECORD = 4096  # bytes that a pipe transfers atomically, pipe(7)
NOT_EXECUTED = 127  # exit code of a process that could not execute its program, as in a shell


class ProcessCreator:
    """Creates processes.

    A process that fails before exec reports the reason through a pipe. New processes wait before exec until `release`:
    running ones would take processor time from the creation of the others, and the last of fifty would start late. If
    this process ends, they stop waiting.
    """

    def __init__(self) -> None:
        self._gate: tuple[int, int] | None = None  # a pipe; its end is the release
        self.waiting = 0  # processes
        self._prctl = ctypes.CDLL(None, use_errno=True).prctl
        self._reader, self._writer = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._failed: dict[str, tuple[int, str]] = {}

    def create(
        self, name: str, argv: list[str], cwd: str, environment: dict[str, str], session_mode: str, stdio: list[int]
    ) -> int:
        """Fork a process that becomes a program after `release`; returns its id.

        `session_mode` is SESSION, GROUP or FOREGROUND; `stdio` are three open files. Raises OSError if no more
        processes can be created.
        """
        parent = os.getpid()
        gate = self._gate = self._gate or os.pipe2(os.O_CLOEXEC)
        pid = os.fork()
        if pid == 0:
            self._execute(name, argv, cwd, environment, session_mode, stdio, parent, gate)
        self.waiting += 1
        return pid

    def release(self) -> None:
        """Let every new process execute its program."""
        if self._gate is not None:
            for descriptor in self._gate:
                os.close(descriptor)
            self._gate = None
            self.waiting = 0

    def find_failure(self, name: str) -> tuple[int, str] | None:
        """Return the errno and its path for a process that failed before executing its program; None for success."""
        try:
            while record := os.read(self._reader, RECORD):
                failed, number, what = marshal.loads(record)  # noqa: S302 - written by ourselves
                self._failed[failed] = (number, what)
        except BlockingIOError:
            pass
        return self._failed.pop(name, None)

    def _execute(
        self,
        name: str,
        argv: list[str],
        cwd: str,
        environment: dict[str, str],
        session_mode: str,
        stdio: list[int],
        parent: int,
        gate: tuple[int, int],
    ) -> NoReturn:
        problem = argv[0]
        try:
            os.close(gate[1])
            if session_mode == SESSION:
                os.setsid()
            else:
                os.setpgid(0, 0)
            if session_mode == FOREGROUND:
                set_foreground(stdio[0], os.getpid())
            self._prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
            if os.getppid() != parent:
                os._exit(NOT_EXECUTED)
            for number, descriptor in enumerate(stdio[:3]):
                os.dup2(descriptor, number)
            signal.set_wakeup_fd(-1)
            for signum in (*IGNORED, signal.SIGCHLD, signal.SIGXFSZ):
                signal.signal(signum, signal.SIG_DFL)
            signal.pthread_sigmask(signal.SIG_SETMASK, [])
            problem = cwd
            os.chdir(cwd)
            problem = argv[0]
            os.read(gate[0], 1)
            os.execvpe(argv[0], argv, environment)  # noqa: S606 - what a process host is for
        except OSError as failure:
            os.write(self._writer, marshal.dumps((name, failure.errno or 0, problem)).ljust(RECORD))
        finally:
            os._exit(NOT_EXECUTED)
