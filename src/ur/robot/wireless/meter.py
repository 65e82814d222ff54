"""Meter of a link, with three processes that run all the time: ping(8), and a shell on either end.

A process that ends, because the robot or the network is down, is restarted.
"""

from __future__ import annotations

import subprocess
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from types import TracebackType

from ur.robot.doctor.wifi import WIFI_SCRIPT, WirelessLink, parse_wifi
from ur.robot.ssh.shell import quote
from ur.robot.wireless.sample import Echoes, Sample

INTERVAL = 0.2  # s between echoes: the minimum that ping allows without root
AGAIN = 1.0  # s until an ended process is restarted
OLD = 3.5  # s without a report after which a link is unknown
PATIENCE = 15  # s without an answer after which the robot's address is looked up again
_MARK = "\x1e"
LOOP = f"while :; do ({WIFI_SCRIPT}\n); printf '\\036\\n' || exit; sleep 1; done"


class ProcessLines:
    """Reads the lines of a process in another thread, calls `read` with each, and restarts the process when it ends."""

    def __init__(self, command: Callable[[], Sequence[str]], read: Callable[[str], None]) -> None:
        self._command, self._read = command, read
        self._over = threading.Event()
        self._process: subprocess.Popen[str] | None = None
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._run, name="lines", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the process and the thread."""
        self._over.set()
        self.renew()
        self._thread.join()

    def renew(self) -> None:
        """End the process, and start a new one unless this object is closed."""
        with self._lock:
            if self._process:
                self._process.kill()

    def _run(self) -> None:
        while not self._over.is_set():
            command = list(self._command())
            with self._lock:
                if self._over.is_set():
                    return
                self._process = subprocess.Popen(
                    command,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.PIPE,
                    stderr=subprocess.DEVNULL,
                    text=True,
                    errors="replace",
                    start_new_session=True,  # Ctrl-C is for this process only
                )
            with self._process as process:
                assert process.stdout is not None
                for line in process.stdout:
                    self._read(line.rstrip("\n"))
            self._over.wait(AGAIN)


class Radio:
    """The wireless links of a computer, parsed from the lines of LOOP.

    `wireless` is None until the first report.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._part: list[str] = []
        self._latest: tuple[float, tuple[WirelessLink, ...]] | None = None
        self.wireless: bool | None = None

    def read(self, line: str) -> None:
        """Parse a line."""
        if not line.startswith(_MARK):
            self._part.append(line)
            return
        text = "\n".join([*self._part, ""])
        self._part.clear()
        self._latest = self._clock(), parse_wifi(text)
        self.wireless = bool(self.wireless) or text.startswith("device ")

    def link(self) -> WirelessLink | None:
        """Return the present state of the link."""
        if self._latest is None or self._clock() - self._latest[0] > OLD or not self._latest[1]:
            return None
        return self._latest[1][0]


class Meter:
    """Measures while its context lasts; entering it raises the errors of `resolve`.

    `login` is the user on the robot, `name` its full name, `resolve` returns its address and is called again when the
    robot is away.
    """

    def __init__(
        self, login: str, name: str, resolve: Callable[[], str], clock: Callable[[], float] = time.time
    ) -> None:
        self._clock, self._echoes, self._lock = clock, Echoes(), threading.Lock()
        self.here, self.there = Radio(clock), Radio(clock)
        self._login, self._name, self._resolve = login, name, resolve
        self._last, self._silent = "", 0

    def __enter__(self) -> Meter:
        self._last = self._resolve()
        self._lines = [
            ProcessLines(self._ping, self._take_ping),
            ProcessLines(lambda: ["sh", "-c", LOOP], self.here.read),
            ProcessLines(self._ssh, self.there.read),
        ]
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        for lines in self._lines:
            lines.close()

    def sample(self) -> Sample:
        """Return the samples measured since the last call."""
        with self._lock:
            sent, lost, latency = self._echoes.pop()
        self._silent = self._silent + 1 if latency is None else 0
        if self._silent and self._silent % PATIENCE == 0:
            self._lines[0].renew()  # it may have another address by now
        return Sample(self._clock(), sent, lost, latency, self.here.link(), self.there.link())

    def _take_ping(self, line: str) -> None:
        with self._lock:
            self._echoes.read(line)

    def _ping(self) -> Sequence[str]:
        with self._lock:
            self._echoes = Echoes()  # the new process counts from 1 again
        return ["ping", "-n", "-O", "-i", str(INTERVAL), self._address()]

    def _ssh(self) -> Sequence[str]:
        settings = (
            *("BatchMode=yes", "StrictHostKeyChecking=yes", f"HostKeyAlias={self._name}", "CheckHostIP=no"),
            *(
                "ConnectTimeout=5",
                "ServerAliveInterval=2",
                "ServerAliveCountMax=3",
                "ForwardX11=no",
                "ControlPath=none",
            ),
            "LogLevel=QUIET",
        )
        options = [word for setting in settings for word in ("-o", setting)]
        return ["ssh", "-T", *options, "--", f"{self._login}@{self._address()}", quote("sh", "-c", LOOP)]

    def _address(self) -> str:
        with suppress(OSError):
            self._last = self._resolve()
        return self._last
