"""One booted computer of the bench."""

from __future__ import annotations

import os
import shlex
import signal
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests.hosts.bench.ledger import children_of


@dataclass(frozen=True, slots=True)
class Done:
    """A command that ended."""

    command: str
    code: int
    out: str
    err: str

    def check(self) -> Done:
        """Itself; raises AssertionError with what was said when the code is not 0."""
        assert self.code == 0, f"{self.command}: exit code {self.code}\n{self.out}\n{self.err}"
        return self


@dataclass(slots=True)
class Machine:
    """A computer: systemd booted in a container, on the bench's bridge and nothing else.

    `name` is what it was called when it was made; its own host name may change. `root` is its file system as seen from
    here. `keeper` is the number of the process that runs its systemd-nspawn, again
    after each reboot.
    """

    name: str
    address: str
    root: Path
    bridge: str
    console: Path
    keeper: int

    @property
    def leader(self) -> int:
        """The process number, here, of its init. Changes at each boot. Raises LookupError while there is none."""
        for nspawn in children_of(self.keeper):
            for child in children_of(nspawn):
                with suppress(OSError):
                    if Path(f"/proc/{child}/comm").read_text().strip() == "systemd":
                        return child
        raise LookupError(f"{self.name} is not up; its console: {self.console}")

    def run(
        self,
        command: str | Sequence[str],
        *,
        user: str = "root",
        stdin: str = "",
        timeout: float = 60.0,
        environment: Mapping[str, str] | None = None,
    ) -> Done:
        """Run a shell command line, or a list of words, as a user with a login environment, from the outside.

        Raises TimeoutExpired after `timeout` seconds.
        """
        line = command if isinstance(command, str) else shlex.join(command)
        done = subprocess.run(
            self.command_line(line, user=user, environment=environment),
            input=stdin,
            capture_output=True,
            text=True,
            errors="replace",
            timeout=timeout,
            check=False,
        )
        return Done(f"{self.name}: {line}", done.returncode, done.stdout, done.stderr)

    def command_line(self, line: str, *, user: str = "root", environment: Mapping[str, str] | None = None) -> list[str]:
        """The words that run a shell command line inside, for those who start the process themselves."""
        settings = "".join(f"export {key}={shlex.quote(value)}; " for key, value in (environment or {}).items())
        inside = ["runuser", "-l", user, "-c", settings + line]
        return ["nsenter", *_namespaces(self.leader), "--", *inside]

    def spawn(self, line: str, *, stdin: int = subprocess.DEVNULL, **how: Any) -> subprocess.Popen[str]:
        """Start a shell command line inside; what it prints, errors too, is to be read. See `command_line`."""
        words, pipe = self.command_line(line, **how), subprocess.PIPE
        return subprocess.Popen(words, stdin=stdin, stdout=pipe, stderr=subprocess.STDOUT, text=True)

    def wait_for(
        self,
        command: str,
        *,
        user: str = "root",
        deadline: float = 30.0,
        environment: Mapping[str, str] | None = None,
    ) -> Done:
        """Run a command until it succeeds. Raises AssertionError with its last words after `deadline` seconds."""
        done = Done(command, -1, "", "never run")

        def succeed() -> bool:
            nonlocal done
            try:
                done = self.run(command, user=user, timeout=min(deadline, 20.0), environment=environment)
            except (LookupError, FileNotFoundError, subprocess.TimeoutExpired):
                return False
            return done.code == 0

        try:
            wait_until(succeed, f"{self.name}: {command}", deadline)
        except AssertionError as problem:
            raise AssertionError(f"{problem}\n{done.out}\n{done.err}") from None
        return done

    def wait_booted(self, deadline: float = 180.0) -> None:
        """Wait until its ssh server and its avahi daemon run, and it is not about to reboot."""
        units = ("ssh", "avahi-daemon", "systemd-networkd")  # is-active is content with one of several
        conditions = ['[ "$(systemctl is-system-running)" != stopping ]']
        conditions += [f"systemctl is-active --quiet {unit}" for unit in units]
        # A device of its own for sshfs: the one of this computer may be for root alone. It is made by the command that
        # checks, which is repeated if a reboot ends it.
        device = "{ [ -e /dev/fuse ] || mknod -m 666 /dev/fuse c 10 229; }"
        self.wait_for(" && ".join([*conditions, device]), deadline=deadline)

    def wait_rebooted(self, leader: int, deadline: float = 180.0) -> None:
        """Wait until it has booted again after `leader` was its init."""

        def other() -> bool:
            _continue_all(leader)
            with suppress(LookupError):
                return self.leader != leader
            return False

        try:
            wait_until(other, f"{self.name} reboots", deadline)
        except AssertionError as problem:
            lines = self.console.read_text(errors="replace").splitlines()[-8:]
            raise AssertionError(f"{problem}; the end of its console: {lines}") from None
        self.wait_booted(deadline)

    def cut(self) -> None:
        """Take it off the network without telling it: the link stays up, nothing arrives."""
        port = self._port()
        _ip("link", "set", port, "nomaster")

    def restore(self) -> None:
        """Put it back on the network; nothing happens when it is there."""
        port = self._port()
        _ip("link", "set", port, "master", self.bridge, "up")

    def write(self, path: str, text: str, *, mode: int = 0o644) -> None:
        """Write a file inside, as root."""
        target = self.root / path.lstrip("/")
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text)
        target.chmod(mode)

    def read(self, path: str) -> str:
        """The text of a file inside."""
        return (self.root / path.lstrip("/")).read_text()

    def journal(self) -> str:
        """Its system log since it was made."""
        return self.run("journalctl --no-pager --quiet").out

    def processes(self) -> list[tuple[int, str]]:
        """The processes that run inside: number as seen from here, and command line, a blank between words."""
        return _processes_of(self.leader)

    def _port(self) -> str:
        done = subprocess.run(
            ["nsenter", *_namespaces(self.leader), "--", "cat", "/sys/class/net/host0/iflink"],
            capture_output=True,
            text=True,
            check=True,
        )
        index = done.stdout.strip()
        for entry in Path("/sys/class/net").iterdir():
            with suppress(OSError):  # another computer's, which goes at this moment
                if (entry / "ifindex").read_text().strip() == index:
                    return entry.name
        raise LookupError(f"{self.name}: no interface {index} here")


def _processes_of(leader: int) -> list[tuple[int, str]]:
    found: list[tuple[int, str]] = []
    try:
        space = Path(f"/proc/{leader}/ns/pid").readlink()
    except OSError:
        return found
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                if (entry / "ns/pid").readlink() == space:
                    words = (entry / "cmdline").read_bytes().replace(b"\0", b" ")
                    found.append((int(entry.name), words.decode(errors="replace").strip()))
            except OSError:
                continue
    return found


def _continue_all(leader: int) -> None:
    """Continue what is stopped: systemd-shutdown stops all for a moment, and runuser then stops itself for good."""
    for number, _ in _processes_of(leader):
        with suppress(OSError):
            os.kill(number, signal.SIGCONT)


def wait_until(condition: Callable[[], bool], what: str, deadline: float = 30.0) -> None:
    """Wait for a condition, asking often. Raises AssertionError naming `what` after `deadline` seconds."""
    end = time.monotonic() + deadline
    while not condition():
        assert time.monotonic() < end, f"not within {deadline:g} s: {what}"
        time.sleep(0.05)


def _namespaces(leader: int) -> list[str]:
    return ["--target", str(leader), "--mount", "--uts", "--ipc", "--net", "--pid", "--root", "--wd"]


def _ip(*words: str) -> None:
    subprocess.run(["ip", *words], check=True, capture_output=True)
