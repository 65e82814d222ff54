"""Messages between the supervisor and the process host over a socket pair.

Messages are tuples. To the host: first `("begin", environment, keep_terminal)`, then `("start", name, argv, cwd,
changes, session_mode)` with the three open files of standard input, output and error, `("signal", name, signum)`,
`("sweep", signum)`. From it: `("started", name, pid)`, `("failed", name, errno, what)`, `("exited", name, code,
signum)`, `("stopped", name)`, `("empty",)`.
"""

from __future__ import annotations

import marshal
import socket

TYPE_CHECKING = False  # what typing.TYPE_CHECKING is, without the 1.3 MB of typing
if TYPE_CHECKING:
    from typing import Any

# Where a process is started, always as the leader of a process group: in a session of its own; in the host's; or there
# as the group that owns the terminal on its standard input. Nodes share the host's where they can: Linux gives every
# session the same share of the processors (sched(7), autogroup), and fifty sessions of nodes starve their master.
SESSION = "session"
GROUP = "group"
FOREGROUND = "foreground"


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
