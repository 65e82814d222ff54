"""Runs that continue without their terminal: start one in another session, wait until it is ready, and detach."""

import os
import signal
import sys
from collections.abc import Callable

from ur.run.record.registry import RunEntry
from ur.source.diagnostic import UserError, user_error_about

Detach = Callable[[RunEntry], None]


def run_detached(run: Callable[[Detach], int], report: Callable[[str], int]) -> int:
    """Call `run` in a new process, which survives this one once it calls the passed `Detach`.

    Until then its output appears on this terminal, and Ctrl-C reaches it. Returns twice, as fork does: in the new
    process the result of `run`, in this one the result of `report` for the id, or the exit code of a run that ended
    before it detached.
    """
    reader, writer = os.pipe2(os.O_CLOEXEC)
    sys.stdout.flush()
    sys.stderr.flush()
    pid = os.fork()
    if pid == 0:
        os.close(reader)
        os.setsid()
        return run(lambda entry: _detach(entry, writer))
    os.close(writer)
    handlers = {
        signum: signal.signal(signum, lambda number, _: os.kill(pid, number))
        for signum in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
    }
    with os.fdopen(reader, "rb") as pipe:
        name = pipe.read().decode()
    for signum, handler in handlers.items():
        signal.signal(signum, handler)
    if name:
        return report(name)
    return _exit_code(os.waitpid(pid, 0)[1])


def _detach(entry: RunEntry, writer: int) -> None:
    null = os.open(os.devnull, os.O_RDONLY)
    try:
        path = f"{entry.log_folder}/{entry.run}.log"
        try:
            log = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o600)
        except OSError as problem:
            reason = (problem.strerror or str(problem)).lower()
            raise user_error_about(path, f"cannot be written: {reason}", rule="bad-log-folder") from None
    except UserError:  # a full disk: the run continues without its log
        log = os.open(os.devnull, os.O_WRONLY)
    for descriptor, number in ((null, 0), (log, 1), (log, 2)):
        os.dup2(descriptor, number)
    os.close(null)
    os.close(log)
    os.write(writer, entry.run.encode())
    os.close(writer)


def _exit_code(status: int) -> int:
    return 128 + os.WTERMSIG(status) if os.WIFSIGNALED(status) else os.WEXITSTATUS(status)
