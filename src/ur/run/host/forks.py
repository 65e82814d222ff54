"""Nodes that share memory: the host's end of `ur_nodes.fork_server`, a process that has imported their modules.

Each node in Python takes 35 MB, most of which it never writes to. Forked from one process, nodes share that; else they
are processes like all others. Where the server has ended or does not answer, nodes are executed.
"""

from __future__ import annotations

import fcntl
import os
from _socket import socketpair

from ur.run.host.protocol import GROUP, receive, send

TYPE_CHECKING = False
if TYPE_CHECKING:
    from _socket import socket as Socket  # noqa: N812 - a class, named as classes are

    from ur.run.host.fork import ProcessCreator

    Start = tuple[str, list[str], str, dict[str, str | None], str, list[int]]

_MOST = 64  # requests without an answer, which the socket takes without blocking
_ROOM = 1024  # characters for the arguments of nodes, which replace those of the server in `ps`


class NodeForks:
    """The requests to the server. `waiting` are starts that it has not answered, by the names of their units."""

    def __init__(self) -> None:
        self._link: Socket | None = None
        self.waiting: dict[str, Start] = {}

    def begin(self, creator: ProcessCreator, command: tuple[str, ...], environment: dict[str, str]) -> None:
        """Start the server, which imports the modules that the command names."""
        ours, theirs = socketpair()
        null = os.open(os.devnull, os.O_RDWR | os.O_CLOEXEC)
        os.set_inheritable(theirs.fileno(), True)
        try:
            argv = [*command, str(theirs.fileno()).rjust(_ROOM)]
            creator.create("", argv, "/", environment, GROUP, [null] * 3)
            self._link = ours
        except OSError:
            ours.close()
        finally:
            theirs.close()
            os.close(null)

    def fileno(self) -> int:
        """Return a descriptor that is readable when there is an answer; -1: there is no server."""
        return -1 if self._link is None else self._link.fileno()

    def request(self, start: Start, words: tuple[str, ...]) -> bool:
        """Request a node: a module and its arguments. False: it has to be executed."""
        if self._link is None or len(self.waiting) >= _MOST:
            return False
        name, _argv, cwd, changes, session_mode, stdio = start
        try:
            send(self._link, (name, list(words), cwd, changes, session_mode), tuple(stdio))
        except OSError:
            return False  # its end is received later
        kept = [fcntl.fcntl(each, fcntl.F_DUPFD_CLOEXEC, 10) for each in stdio]
        self.waiting[name] = (*start[:-1], kept)
        return True

    def receive(self) -> tuple[str, int, int] | None:
        """Return the name and process id of a node, and the pipe that lets it run by a byte. None: the server ended."""
        assert self._link is not None
        try:
            (name, pid), (gate,) = receive(self._link)
        except (EOFError, OSError, ValueError):
            return None
        for each in self.waiting.pop(name)[-1]:
            os.close(each)
        return name, pid, gate

    def end(self) -> list[Start]:
        """Let the server end; nodes that wait for their pipe end, too. Returns the starts without an answer."""
        if self._link is not None:
            self._link.close()
            self._link = None
        left = list(self.waiting.values())
        self.waiting.clear()
        return left
