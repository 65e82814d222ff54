"""Creation of a process: the steps between fork and exec."""

from __future__ import annotations

import ctypes
import marshal
import os
import signal

from ur.run.host.descendants import IGNORED, PR_SET_PDEATHSIG
from ur.run.host.protocol import FOREGROUND, SESSION
from ur.run.host.terminal import take_foreground

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import NoReturn

RECORD = 4096  # bytes that a pipe takes in one piece, pipe(7)
NOT_EXECUTED = 127  # the exit code of a process that could not become its program, as a shell's


class ProcessCreator:
    """Fork and exec, where a process that fails before exec reports the reason itself, through a pipe."""

    def __init__(self) -> None:
        self._prctl = ctypes.CDLL(None, use_errno=True).prctl
        self._reader, self._writer = os.pipe2(os.O_CLOEXEC | os.O_NONBLOCK)
        self._failed: dict[str, tuple[int, str]] = {}

    def create(
        self, name: str, argv: list[str], cwd: str, environment: dict[str, str], session_mode: str, stdio: list[int]
    ) -> int:
        """Fork a process that becomes a program; returns its id. OSError when there can be no more processes.

        `session_mode` is SESSION, GROUP or FOREGROUND; `stdio` are three open files.
        """
        parent = os.getpid()
        pid = os.fork()
        if pid == 0:
            self._execute(name, argv, cwd, environment, session_mode, stdio, parent)
        return pid

    def find_failure(self, name: str) -> tuple[int, str] | None:
        """The errno, and the path that it is about, of a process that never became its program; None when it did."""
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
    ) -> NoReturn:
        problem = argv[0]
        try:
            if session_mode == SESSION:
                os.setsid()
            else:
                os.setpgid(0, 0)
            if session_mode == FOREGROUND:
                take_foreground(stdio[0], os.getpid())
            self._prctl(PR_SET_PDEATHSIG, int(signal.SIGKILL), 0, 0, 0)
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
            os.execvpe(argv[0], argv, environment)  # noqa: S606 - the purpose of a process host
        except OSError as failure:
            os.write(self._writer, marshal.dumps((name, failure.errno or 0, problem)).ljust(RECORD))
        finally:
            os._exit(NOT_EXECUTED)
