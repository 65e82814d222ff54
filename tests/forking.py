"""Programs in Python that tests start often: one interpreter imports their modules, and forks for each run."""

import atexit
import contextlib
import functools
import json
import os
import select
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path

from ur.cli.verbs import VERBS

SERVER = Path(__file__).with_name("forking_server.py")
MORE = (
    "ur.cli.main",
    "ur.cli.launch.launch",
    "ur.cli.launch.options",
    "ur.run.loop",
    "ur.check.session",
)
"""What commands import when they run, beside the module of their verb."""


class ForkedProcess:
    """A process that ForkingPython has started, with what tests use of `subprocess.Popen`."""

    def __init__(self, pid: int, report: int) -> None:
        """`report` is the pipe of its exit code."""
        self.pid = pid
        self.returncode: int | None = None
        self._report = report

    def poll(self) -> int | None:
        """Return its exit code, negative for a signal; None: it runs."""
        if self.returncode is None and select.select([self._report], [], [], 0)[0]:
            self._read_code()
        return self.returncode

    def wait(self, timeout: float | None = None) -> int:
        """Wait for its end; return its exit code, or raise `subprocess.TimeoutExpired`."""
        if self.returncode is None:
            if not select.select([self._report], [], [], timeout)[0]:
                raise subprocess.TimeoutExpired(str(self.pid), timeout or 0.0)
            self._read_code()
        assert self.returncode is not None
        return self.returncode

    def send_signal(self, number: int) -> None:
        """Send a signal where it runs."""
        if self.poll() is None:
            with contextlib.suppress(ProcessLookupError):  # it has ended since
                os.kill(self.pid, number)

    def terminate(self) -> None:
        """Send SIGTERM."""
        self.send_signal(signal.SIGTERM)

    def kill(self) -> None:
        """Send SIGKILL."""
        self.send_signal(signal.SIGKILL)

    def _read_code(self) -> None:
        answer = os.read(self._report, 16)
        os.close(self._report)
        assert answer, f"process {self.pid}: the interpreter that forks has ended"
        self.returncode = int(answer)


class ForkingPython:
    """Starts programs as `subprocess` does, without the start of an interpreter for each.

    A program is a process with its own arguments, environment, folder and streams; its parent is the interpreter that
    forks, whose command line it has. What its modules read from the environment when they are imported they have read
    before, and its streams have the encoding of C.UTF-8.
    """

    def __init__(self, *command: str, modules: Sequence[str]) -> None:
        """`command` starts Python."""
        self._lock = threading.Lock()
        self._socket, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            words = [*command, str(SERVER), str(theirs.fileno()), *modules]
            environment = {**os.environ, "LC_ALL": "C.UTF-8", "ROOM": "." * 32768}  # the programs' own is put there
            self._server = subprocess.Popen(
                words, env=environment, stdin=subprocess.DEVNULL, pass_fds=[theirs.fileno()]
            )

    def start(
        self,
        program: str,
        *arguments: str,
        folder: Path,
        environment: Mapping[str, str],
        streams: tuple[int, int, int],
        blocked: bool = False,
    ) -> ForkedProcess:
        """Start a file, or a module by its name.

        `streams` are the descriptors for standard input, output and errors, or `subprocess.DEVNULL`. With `blocked`
        SIGINT waits until the program lets it in.
        """
        request = {
            "program": program,
            "arguments": arguments,
            "environment": dict(environment),
            "folder": str(folder),
            "blocked": blocked,
        }
        report, theirs = os.pipe()
        null = os.open(os.devnull, os.O_RDWR)
        try:
            descriptors = [null if each == subprocess.DEVNULL else each for each in streams]
            with self._lock:
                socket.send_fds(self._socket, [json.dumps(request).encode()], [*descriptors, theirs])
                answer = self._socket.recv(16)
        finally:
            os.close(theirs)
            os.close(null)
        assert answer, f"{program} {' '.join(arguments)}: the interpreter that forks has ended"
        return ForkedProcess(int(answer), report)

    def run(
        self,
        program: str,
        *arguments: str,
        folder: Path,
        environment: Mapping[str, str],
        given: bytes = b"",
        timeout: float = 120.0,
    ) -> subprocess.CompletedProcess[bytes]:
        """Run a program to its end; `given` is its standard input."""
        with tempfile.TemporaryFile() as stdin, tempfile.TemporaryFile() as stdout, tempfile.TemporaryFile() as stderr:
            stdin.write(given)
            stdin.seek(0)
            streams = (stdin.fileno(), stdout.fileno(), stderr.fileno())
            process = self.start(program, *arguments, folder=folder, environment=environment, streams=streams)
            try:
                code = process.wait(timeout)
            finally:
                process.kill()
            stdout.seek(0)
            stderr.seek(0)
            return subprocess.CompletedProcess([program, *arguments], code, stdout.read(), stderr.read())

    def close(self) -> None:
        """End the interpreter."""
        self._socket.close()
        self._server.wait()


@functools.cache
def python_of_ur() -> ForkingPython:
    """Return the interpreter that has imported the commands of `ur`; it runs until this process ends."""
    modules = [*(verb.module for verb in VERBS.values()), *MORE]
    return _keep(ForkingPython(sys.executable, "-I", modules=modules))


@functools.cache
def python_of_ros() -> ForkingPython:
    """Return the interpreter of the system, which has imported roslaunch and the master; it runs likewise."""
    return _keep(ForkingPython("/usr/bin/python3", modules=["roslaunch", "rosmaster.main"]))


def add_rosversion(folder: Path) -> str:
    """Make a `rosversion` that answers at once, which roslaunch runs twice for each file; return a PATH with it."""
    program = folder / "bin/rosversion"
    program.parent.mkdir(exist_ok=True)
    program.write_text("#!/bin/sh\necho 1.0.0\n")
    program.chmod(0o755)
    return f"{program.parent}:/usr/bin:/bin"


def run_ur(
    *words: str, folder: Path | None = None, environment: Mapping[str, str] | None = None, given: str = ""
) -> subprocess.CompletedProcess[str]:
    """Run `ur` to its end; by default it has the folder and the environment of this process."""
    done = python_of_ur().run(
        "ur",
        *words,
        folder=folder or Path.cwd(),
        environment=os.environ if environment is None else environment,
        given=given.encode(),
    )
    return subprocess.CompletedProcess(done.args, done.returncode, done.stdout.decode(), done.stderr.decode())


def _keep(python: ForkingPython) -> ForkingPython:
    atexit.register(python.close)
    return python
