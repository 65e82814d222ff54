"""Child processes: their sockets, their errors, and their end."""

import asyncio
import signal
import socket
import subprocess
import sys

import psutil
import pytest
from tests.json_client import wait_until

from ur.system.child_processes import read_errors, start_child, wait_or_kill

_PROGRAM = r"""
import socket, sys
end = socket.socket(fileno=int(sys.argv[1]))
sys.stderr.buffer.write(b"one\n\xfftwo\n")
sys.stderr.flush()
end.recv(1)
"""


async def start() -> tuple[asyncio.subprocess.Process, socket.socket]:
    """A program that prints two lines and ends with the connection."""
    ours, theirs = socket.socketpair()
    process = await start_child((sys.executable, "-I", "-c", _PROGRAM), (theirs,), {})
    assert theirs.fileno() == -1  # closed here, so that the program's end closes the connection
    return process, ours


async def test_lines_of_errors_are_passed_on_until_the_process_ends() -> None:
    process, ours = await start()
    ours.close()
    lines: list[str] = []
    await read_errors(process, lines.append)
    await wait_or_kill(process)
    assert lines == ["one", "\ufffdtwo"]
    assert process.returncode == 0


@pytest.mark.parametrize("limit", [0.0, 0.05])
async def test_process_that_does_not_end_is_killed(limit: float) -> None:
    process, ours = await start()
    with ours:
        await wait_or_kill(process, limit)
    assert process.returncode == -signal.SIGKILL


SERVER = """
import asyncio, socket, sys
from ur.system.child_processes import start_child

async def serve():
    ours, theirs = socket.socketpair()
    process = await start_child(("sleep", "600"), (theirs,), {})
    print(process.pid, flush=True)
    await process.wait()

asyncio.run(serve())
"""


def test_process_that_does_not_read_its_socket_ends_when_its_server_is_killed() -> None:
    with subprocess.Popen([sys.executable, "-c", SERVER], stdout=subprocess.PIPE) as server:
        assert server.stdout is not None
        child = psutil.Process(int(server.stdout.readline()))
        wait_until(lambda: child.name() == "sleep", 60.0, "setpriv, which asks for the signal, to start the program")
        server.kill()
    child.wait(60)
