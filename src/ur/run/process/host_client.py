"""The supervisor's end of the process host: start it, send requests, receive events."""

import os
import socket
import sys
from collections.abc import Mapping

from ur.run.host import __file__ as host_file
from ur.run.host.descendants import inherit_orphans, kill_descendants
from ur.run.host.protocol import SESSION, receive, send
from ur.run.supervisor.events import Event, Exited, NothingLeft, Started, StartFailed
from ur.run.supervisor.state import ExitStatus
from ur.source.diagnostic import UserError, error


class Suspended:
    """A unit was stopped by its terminal (Ctrl-Z) or by a signal, and can continue."""

    __slots__ = ("name",)

    def __init__(self, name: str) -> None:
        self.name = name


class HostLost(Exception):  # noqa: N818 - an event, named as events are
    """The process host has ended; its processes with it."""


class ProcessHost:
    """Owns the processes of a run (see `ur.run.host`). Made by `start_host`."""

    def __init__(self, link: socket.socket, pid: int) -> None:
        self._link = link
        self.pid = pid  # of the guard

    def fileno(self) -> int:
        """Return a descriptor that is readable when there is something to receive."""
        return self._link.fileno()

    def begin(self, environment: Mapping[str, str], *, keep_terminal: bool, server: tuple[str, ...] = ()) -> None:
        """Send, before any start, the environment of processes, and whether one of them needs the terminal.

        `server` is the command of a process that forks nodes (`ur.run.host.forks`), empty for none.
        """
        self._send(("begin", dict(environment), keep_terminal, server))

    def start_process(
        self,
        name: str,
        argv: list[str],
        cwd: str,
        changes: Mapping[str, str | None],
        stdio: tuple[int, int, int],
        session_mode: str = SESSION,
        words: tuple[str, ...] = (),
    ) -> None:
        """Start a program; `session_mode` is SESSION, GROUP or FOREGROUND of `ur.run.host.protocol`.

        `changes` override the environment, None removes a variable. `stdio` are open files; they may be closed after
        this call. `words` are the module of a node that the server may fork instead, and its arguments. The answer is
        Started, or StartFailed.
        """
        self._send(("start", name, argv, cwd, dict(changes), session_mode, words), stdio)

    def signal_process(self, name: str, signum: int) -> None:
        """Signal the process group of a unit, if it is still running."""
        self._send(("signal", name, int(signum)))

    def sweep(self, signum: int) -> None:
        """Signal all remaining processes; the answer is NothingLeft once there is none."""
        self._send(("sweep", int(signum)))

    def receive(self) -> Event | Suspended:
        """Return the next event of the host; block until there is one. Raises HostLost."""
        try:
            (kind, *rest), _ = receive(self._link)
        except (EOFError, OSError):
            raise HostLost from None
        if kind == "started":
            return Started(rest[0], rest[1])
        if kind == "exited":
            return Exited(rest[0], ExitStatus(rest[1], rest[2]))
        if kind == "failed":
            return StartFailed(rest[0], _explain_failure(rest[1], rest[2]))
        return Suspended(rest[0]) if kind == "stopped" else NothingLeft()

    def close(self) -> None:
        """End the host and all running processes, and wait for it."""
        self._link.close()
        try:
            status = os.waitpid(self.pid, 0)[1]
        except ChildProcessError:
            return
        if os.WIFSIGNALED(status):  # guard and host were killed: this process has inherited their children
            kill_descendants(2.0)
            from ur.run.host.cgroup import find_cgroup  # almost never

            cgroup = find_cgroup(self.pid)
            if cgroup is not None:
                cgroup.kill()
                cgroup.remove(1.0)

    def _send(self, message: tuple[object, ...], descriptors: tuple[int, ...] = ()) -> None:
        try:
            send(self._link, message, descriptors)
        except OSError:
            raise HostLost from None


def start_host() -> ProcessHost:
    """Start the process host, and make this process inherit orphans if host and guard are killed."""
    inherit_orphans()
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_STREAM)
    python = os.path.realpath(sys.executable)
    null = os.open(os.devnull, os.O_RDWR | os.O_CLOEXEC)
    descriptor = theirs.fileno()
    program = os.path.join(os.path.dirname(host_file), "__main__.py")  # noqa: PTH118, PTH120 - pathlib is slow to import
    os.set_inheritable(descriptor, True)
    try:
        pid = os.posix_spawn(
            python,
            [python, "-I", "-S", program, str(descriptor)],
            {"LC_ALL": "C.UTF-8"},
            file_actions=[(os.POSIX_SPAWN_DUP2, null, number) for number in range(3)],
            setpgroup=0,
        )
    except OSError as problem:
        raise UserError(
            error(f"cannot start {python}: {(problem.strerror or '').lower()}", rule="no-process-host")
        ) from None
    finally:
        os.close(null)
        theirs.close()
    return ProcessHost(ours, pid)


def _explain_failure(number: int, what: str) -> str:
    if number == 8:  # ENOEXEC
        return f"{what}: not a program, expected a script to begin with '#!' or a binary for this computer"
    if not what:
        return f"no process could be made: {os.strerror(number).lower()}"
    return f"{what}: {os.strerror(number).lower()}"
