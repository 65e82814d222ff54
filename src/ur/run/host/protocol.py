"""What the supervisor and the process host say to each other over a socket pair, and how.

Messages are tuples. To the host: `("environment", {...})`, `("start", name, argv, cwd, changes, place)` with the three
open files of standard input, output and error, `("signal", name, signum)`, `("sweep", signum)`. From it: `("started",
name, pid)`, `("failed", name, errno, what)`, `("exited", name, code, signum)`, `("stopped", name)`, `("empty",)`.
"""

from __future__ import annotations

import marshal
import socket

TYPE_CHECKING = False  # what typing.TYPE_CHECKING is, without the 1.3 MB of typing
if TYPE_CHECKING:
    from typing import Any

SESSION = "session"  # where a process is started: in a session of its own, with no terminal,
GROUP = "group"  # in the terminal's session,
FOREGROUND = "foreground"  # or there as the group that owns the terminal on its standard input


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
