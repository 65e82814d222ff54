"""Fork nodes from one process that has imported their modules, so that they share its memory.

    python -I -m ur_nodes ur_nodes.fork_server FOLDER MODULE ... DESCRIPTOR

The process host starts it with the modules that a run needs, and sends a request for each node (`ur.run.host.forks`);
a page requests its node by a socket in FOLDER, that of the run, unless it is empty (`ur.web.server.robot_process`).
Each node is forked twice, so that it becomes a child of the host, and waits until the client knows it. Memory that is
not written to stays shared: objects that the garbage collector leaves alone, since they are frozen. The server has no
threads, and ends after IDLE s without a request, or when the host has closed the socket.
"""

import ctypes
import gc
import os
import runpy
import select
import signal
import socket
import sys
import time
from collections.abc import Sequence
from contextlib import suppress
from importlib import import_module

from ur.run.host.descendants import PR_SET_PDEATHSIG
from ur.run.host.protocol import FORKS, SESSION, receive, send
from ur_nodes.run import backend_name

IDLE = 30.0  # s
_PAGE_LIMIT = 1.0  # s
_NOT_STARTED = 127  # exit code
_ALL_LATER = {
    "ros1": (
        *("configparser", "encodings.idna", "importlib.readers", "netifaces"),
        *("actionlib", "dynamic_reconfigure.server", "std_srvs.srv"),
        *(f"ur_nodes.ros1.{name}" for name in ("run", "goals", "services", "topics", "recorder.recorder")),
        *(f"ur_nodes.codecs.{name}" for name in ("maps", "motion", "nav2.services", "sensors", "services", "simple")),
    ),
    "ros2": ("ur_nodes.ros2.run",),
}
"""What nodes import after their start."""

Request = tuple[str, list[str], str, dict[str, "str | None"], str]
"""The name of the unit, the module and its arguments, the folder, changes of the environment, the session mode."""


def main(arguments: Sequence[str]) -> None:
    """Serve until the host closes the socket. In a forked node: run it, which raises SystemExit."""
    folder, *modules, descriptor = arguments
    _show_arguments(sys.orig_argv[:5])  # who looks for a node by its module finds the node alone
    with socket.socket(fileno=int(descriptor)) as link, socket.socket(socket.AF_UNIX) as pages:
        with suppress(OSError):  # no folder, or too long a path: pages execute their nodes
            pages.bind(f"{folder or os.devnull}/{FORKS}")
            pages.listen()
        words = _serve(link, pages, modules)
    if words is None:
        return
    read_arguments(words)
    sys.modules.pop(words[0], None)  # runpy warns where a module is imported already
    runpy.run_module(words[0], run_name="__main__", alter_sys=True)


def read_arguments(words: list[str]) -> None:
    """Have Python and rospy read the arguments and the namespace of a node, in place of those of the server."""
    sys.argv = words
    if (names := sys.modules.get("rospy.names")) is not None:
        names.reload_mappings(words)
        names._set_caller_id(f"{names.get_ros_namespace()}unnamed")  # noqa: SLF001 - as rospy does it on import


def _serve(link: socket.socket, pages: socket.socket, modules: Sequence[str]) -> list[str] | None:
    """Import modules, and fork a node for each request. Returns in a node its module and arguments, None at the end."""
    for module in (*_ALL_LATER.get(backend_name(), ()), *modules):
        if select.select([link], [], [], 0)[0] and not link.recv(1, socket.MSG_PEEK):
            return None
        with suppress(Exception):  # the node that needs it reports this
            import_module(module)
    if (node_start := sys.modules.get("ur_nodes.ros1.run")) is not None:
        node_start.bound_connections()  # once for all nodes: it writes to many pages
        node_start.send_at_once()
    gc.collect()
    gc.freeze()
    host = os.getppid()
    watched = [link, pages] if pages.getsockname() else [link]
    while ready := select.select(watched, [], [], IDLE)[0]:
        client = link if link in ready else pages.accept()[0]
        client.settimeout(IDLE if client is link else _PAGE_LIMIT)
        stdio, pipe, pid = list[int](), tuple[int, ...](), -1
        try:
            request, stdio = receive(client)
            gate, opener = pipe = os.pipe()
            if pid := _fork_twice():
                send(client, (request[0], pid), (opener,))
        except (EOFError, OSError, ValueError):
            if client is link:
                return None
            client.close()  # a page does not wait for an answer then
        if not pid:
            client.close()
            os.close(opener)
            return _enter(request, stdio, gate, host)
        for each in (*stdio, *pipe):
            os.close(each)
    return None


def _fork_twice() -> int:
    """Fork a process whose parent has ended; return 0 in it, and its id in this process. Raises OSError."""
    reader, writer = os.pipe()
    between = os.fork()
    if between == 0:
        parent = os.getpid()
        with suppress(OSError):
            if (pid := os.fork()) == 0:
                os.close(reader)
                os.close(writer)
                while os.getppid() == parent:
                    time.sleep(0.001)
                return 0
            os.write(writer, str(pid).encode())
        os._exit(0)
    os.close(writer)
    found = os.read(reader, 20)
    os.close(reader)
    os.waitpid(between, 0)
    if not found:
        raise ChildProcessError("no process could be made")
    return int(found)


def _enter(request: Request, stdio: Sequence[int], gate: int, host: int) -> list[str]:
    """Become the process that a request describes, as `ur.run.host.fork` makes it, once the host knows this one."""
    name, words, folder, changes, session_mode = request
    if not name:  # a page gives all of its environment
        os.environ.clear()
    if session_mode == SESSION:
        os.setsid()
    else:
        os.setpgid(0, 0)
    ctypes.CDLL(None).prctl(PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
    _show_arguments([*sys.orig_argv[:4], *words])
    if os.getppid() != host or not os.read(gate, 1):
        os._exit(_NOT_STARTED)
    os.close(gate)
    for number, each in enumerate(stdio):
        os.dup2(each, number)
        os.close(each)
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(line_buffering=stream is sys.stderr or stream.isatty())  # type: ignore[union-attr]
    try:
        os.chdir(folder)
    except OSError as problem:
        sys.stderr.write(f"error: {folder}: {(problem.strerror or '').lower()}\n")
        os._exit(_NOT_STARTED)
    for name, value in changes.items():
        if value is None:
            os.environ.pop(name, None)
        else:
            os.environ[name] = value
    return words


def _show_arguments(arguments: Sequence[str]) -> None:
    """Write arguments where `ps` reads those of this process, as far as there is room. See proc(5), arg_start."""
    with open("/proc/self/stat", "rb") as file:  # noqa: PTH123 - as short
        start, end = map(int, file.read().rpartition(b")")[2].split()[45:47])
    text = b"\0".join(each.encode(errors="surrogateescape") for each in arguments)[: end - start - 1]
    ctypes.memmove(start, text.ljust(end - start, b"\0"), end - start)


if __name__ == "__main__":
    main(sys.argv[1:])
