"""Messages between the supervisor and the process host over a socket pair.

Messages are tuples. To the host: first `("begin", environment, keep_terminal, server)`, then `("start", name, argv,
cwd, changes, session_mode, words)` with the three open files of standard input, output and error, `("signal", name,
signum)`, `("sweep", signum)`. From it: `("started", name, pid)`, `("failed", name, errno, what)`, `("exited", name,
code, signum)`, `("stopped", name)`, `("empty",)`.
"""

from __future__ import annotations

import marshal
from _socket import CMSG_SPACE, MSG_CMSG_CLOEXEC, SCM_RIGHTS, SOL_SOCKET
from struct import calcsize, unpack
from struct import pack as pack_struct

TYPE_CHECKING = False  # what typing.TYPE_CHECKING is, without the 1.3 MB of typing
if TYPE_CHECKING:
    from _socket import socket as Socket  # noqa: N812 - a class, named as classes are
    from typing import Any

_INT = calcsize("i")

# The kinds of a new process, which always leads a process group: in its own session; in the host's; or in the host's
# as the group that owns the terminal on its standard input. Nodes share the host's session if possible: Linux gives
# each session the same share of the processors (sched(7), autogroup), and fifty sessions starve their master.
SESSION = "session"
GROUP = "group"
FOREGROUND = "foreground"

FORKS = "forks"
"""The socket in the folder of a run through which pages request nodes that share its memory."""


def pack(message: tuple[Any, ...]) -> bytes:
    """Encode a message. Both ends run the same Python, so `marshal` is safe."""
    data = marshal.dumps(message)
    return len(data).to_bytes(4, "little") + data


def send(link: Socket, message: tuple[Any, ...], descriptors: tuple[int, ...] = ()) -> None:
    """Send one message, with open files."""
    data = pack(message)
    if descriptors:
        data = data[
            link.sendmsg([data], [(SOL_SOCKET, SCM_RIGHTS, pack_struct(f"{len(descriptors)}i", *descriptors))]) :
        ]
    if data:  # the other end may have what it needs, and be closed
        link.sendall(data)


def receive(link: Socket) -> tuple[tuple[Any, ...], list[int]]:
    """Receive one message with three open files at most. EOFError when the other end has closed."""
    head, others, _, _ = link.recvmsg(4, CMSG_SPACE(3 * _INT), MSG_CMSG_CLOEXEC)
    descriptors: list[int] = []
    for level, kind, data in others:
        if level == SOL_SOCKET and kind == SCM_RIGHTS:
            count = len(data) // _INT
            descriptors += unpack(f"{count}i", data[: count * _INT])
    while len(head) < 4:
        more = link.recv(4 - len(head)) if head else b""
        if not more:
            raise EOFError
        head += more
    size = int.from_bytes(head, "little")
    body = bytearray()
    while len(body) < size:
        part = link.recv(size - len(body))
        if not part:
            raise EOFError
        body += part
    return marshal.loads(body), descriptors  # noqa: S302 - from our own other half
