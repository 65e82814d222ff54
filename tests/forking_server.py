"""Run programs in forks of this interpreter, which has imported modules already: forking_server.py SOCKET MODULE ...

SOCKET is the descriptor of a socket that keeps the limits of messages. Each message is a request as JSON: `program`, a
file or the name of a module; `arguments`, `environment`, `folder`, and `blocked`, whether the program itself unblocks
SIGINT. With it come four descriptors: standard input, output and errors, and a pipe for the exit code, negative for a
signal. The answer is the process id. For /usr/bin/python3 as well, so without any package.
"""

import atexit
import gc
import importlib
import json
import os
import runpy
import selectors
import signal
import socket
import sys
import threading
from typing import Any

LARGEST = 1 << 20  # bytes of a request


def become(request: dict[str, Any], streams: list[int]) -> None:
    """Make this process the one that a request describes, up to its program."""
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
    os.closerange(3, 1024)
    os.environ.clear()
    os.environ.update(request["environment"])
    show_environment(request["environment"])
    os.chdir(request["folder"])
    sys.argv[:] = [request["program"], *request["arguments"]]  # a default argument may be this list
    sys.stdout.reconfigure(line_buffering=os.isatty(1))  # type: ignore[union-attr]
    signal.signal(signal.SIGHUP, signal.SIG_DFL)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if not request["blocked"]:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, (signal.SIGINT,))


def show_environment(environment: dict[str, str]) -> None:
    """Let /proc/PID/environ show it, for tests that find their processes by that."""
    text = b"".join(os.fsencode(f"{name}={value}") + b"\0" for name, value in environment.items())
    with open("/proc/self/stat", "rb") as file:  # noqa: PTH123 - here and below: in each run
        span = [int(each) for each in file.read().rpartition(b")")[2].split()[47:49]]
    if not span:  # an emulated computer tells less
        return
    start, end = span
    assert len(text) <= end - start, "the interpreter that forks was started with too small an environment"
    with open("/proc/self/mem", "r+b") as memory:  # noqa: PTH123
        memory.seek(start)
        memory.write(text.ljust(end - start, b"\0"))


def run_program(program: str) -> None:
    """Run it and end as the interpreter does, but for the teardown of modules, which takes longer than most runs."""
    run = runpy.run_path if "/" in program else runpy.run_module
    code = 0
    try:
        run(program, run_name="__main__")
    except SystemExit as end:
        if not isinstance(end.code, (int, type(None))):
            raise
        code = end.code or 0
    threading._shutdown()  # type: ignore[attr-defined]
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        if stream and not stream.closed:
            stream.flush()
    os._exit(code & 0xFF)


def serve(requests: socket.socket) -> tuple[dict[str, Any], list[int]]:
    """Answer requests; return one of them, with its streams, where it is to be run, in a fork."""
    with selectors.DefaultSelector() as selector:
        selector.register(requests, selectors.EVENT_READ)
        while True:
            for key, _ in selector.select():
                if key.fileobj is requests:
                    data, descriptors, _, _ = socket.recv_fds(requests, LARGEST, 4)
                    if not data:
                        sys.exit()
                    *streams, report = descriptors
                    child = os.fork()
                    if child == 0:
                        return json.loads(data), streams
                    for each in streams:
                        os.close(each)
                    selector.register(os.pidfd_open(child), selectors.EVENT_READ, (child, report))
                    requests.send(b"%d" % child)
                else:
                    selector.unregister(key.fileobj)
                    os.close(key.fd)
                    child, report = key.data
                    _, status = os.waitpid(child, 0)
                    os.write(report, b"%d" % os.waitstatus_to_exitcode(status))
                    os.close(report)


if __name__ == "__main__":
    signal.pthread_sigmask(signal.SIG_BLOCK, (signal.SIGINT,))  # Ctrl-C is for the programs
    for name in sys.argv[2:]:
        importlib.import_module(name)
    if not sys.flags.isolated:
        sys.path.pop(0)  # the folder of this file
    gc.freeze()
    wanted, its_streams = serve(socket.socket(fileno=int(sys.argv[1])))
    become(wanted, its_streams)
    run_program(wanted["program"])
