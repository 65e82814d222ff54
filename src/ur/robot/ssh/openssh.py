"""One connection to another computer: the OpenSSH client's master mode, so that a command costs one round trip."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path

from ur.robot.ssh.askpass import answer_password
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import Done, quote, run_process
from ur.source.diagnostic import UserError, error

CONNECT_SECONDS = 10
_SUDO_REFUSED = re.compile(r"^sudo: (\d+ incorrect|no password|a password is required)", re.MULTILINE)
# Where the shared connection is gone, ssh would make one of its own: ten seconds of silence, and without the password.
_ONLY_SHARED = ("-o", "ProxyCommand=false")
_USER = re.compile(r"[a-z_][a-z0-9_-]{0,31}")
_HOST = re.compile(r"[A-Za-z0-9]([A-Za-z0-9.:-]*[A-Za-z0-9])?")


@dataclass(frozen=True, slots=True)
class Address:
    """Whom to log in as, and where."""

    user: str
    host: str

    def __str__(self) -> str:
        return f"{self.user}@{self.host}"


def parse_address(text: str, default_user: str) -> Address:
    """Read [USER@]HOST; a HOST without a dot is a zeroconf name: HOST.local. Raises UserError."""
    user, at, host = text.rpartition("@")
    user = user if at else default_user
    if not _USER.fullmatch(user) or not _HOST.fullmatch(host):
        raise UserError(
            error(
                f"{text!r} is not the address of a computer, expected HOST or USER@HOST, for instance ros@robot.local",
                rule="bad-address",
            )
        )
    return Address(user, host if "." in host or ":" in host else f"{host}.local")


class SshShell:
    """Scripts on another computer. Made by `connect`, which also ends it."""

    def __init__(self, address: Address, options: Sequence[str], sudo_password: Secret | None = None) -> None:
        self.address = address
        self._options = options
        self._sudo = sudo_password
        self._candidates: Sequence[Secret] = ()

    @property
    def place(self) -> str:
        """The address."""
        return str(self.address)

    @property
    def words(self) -> list[str]:
        """The ssh command, up to the address, that uses this connection: for programs that start ssh themselves."""
        return ["ssh", *_ONLY_SHARED, *self._options]

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> Done:
        """Run a script with sh there. With `root`, by sudo, which reads the password from the connection.

        Raises UserError when the connection is gone.
        """
        done = self._run(script, root, stdin, timeout)
        if root and done.code and _SUDO_REFUSED.search(done.err) and self.find_sudo(self._candidates):
            done = self._run(script, root, stdin, timeout)  # it had not begun: the password is another one by now
        return done

    def _run(self, script: str, root: bool, stdin: str | Secret, timeout: float) -> Done:
        text = stdin.reveal() if isinstance(stdin, Secret) else stdin
        # 255 is what ssh itself says when the connection breaks, so no script may.
        whole = f"({script}\n); code=$?; [ $code -ne 255 ] || code=254; exit $code"
        command = quote("sh", "-c", whole)
        if root and self._sudo is not None:
            command = f"LC_ALL=C sudo -k -S -p '' -- {command}"
            text = f"{self._sudo.reveal()}\n{text}"
        elif root:
            command = f"LC_ALL=C sudo -n -- {command}"
        done = run_process(
            [*self.words, self.place, command],
            stdin=Secret(text),
            timeout=timeout,
            what=f"a command on {self.place}",
        )
        if done.code == 255:
            raise lost_connection(self.place, done.err)
        if done.code and is_expired(done.err):
            raise expired_password(self.address)
        return done

    def find_sudo(self, candidates: Sequence[Secret]) -> bool:
        """Find which way of using sudo works: without a password, or with one of these. Whether there is one."""
        self._candidates = tuple(candidates)
        if self._run("sudo -k -n true", False, "", 30).code == 0:
            self._sudo = None
            return True
        for candidate in candidates:
            self._sudo = candidate
            if self._run("true", True, "\n", 30).code == 0:
                return True
        self._sudo = None
        return False


@contextmanager
def connect(
    address: Address,
    *,
    password: Secret | None = None,
    known_hosts: Path | None = None,
    options: Sequence[str] = (),
) -> Iterator[SshShell]:
    """Log in, by key or, with `password`, by that alone; the connection ends with the context.

    Host keys must be known: in the user's own files, or in `known_hosts` alone, where an unknown one is then written.
    Raises UserError, which says which of these failed: name, network, host key, login.
    """
    with tempfile.TemporaryDirectory(prefix="ur-") as name:
        folder = Path(name)
        common = [*_common(folder / "c"), *options]
        if known_hosts:
            common += ["-o", f"UserKnownHostsFile={known_hosts}", "-o", "GlobalKnownHostsFile=/dev/null"]
            common += ["-o", "StrictHostKeyChecking=accept-new", "-o", "HashKnownHosts=no"]
        else:
            common += ["-o", "StrictHostKeyChecking=yes"]
        _log_in(address, common, folder, password)
        try:
            yield SshShell(address, common)
        finally:
            run_process(["ssh", *common, "-O", "exit", str(address)], timeout=20, what="closing a connection")


def _common(socket: Path) -> list[str]:
    settings = (
        f"ControlPath={socket}",
        f"ConnectTimeout={CONNECT_SECONDS}",
        "ServerAliveInterval=5",
        "ServerAliveCountMax=3",
        "ForwardX11=no",
        "ClearAllForwardings=yes",
        "PermitLocalCommand=no",
        "LogLevel=ERROR",
    )
    return ["-T", *(word for setting in settings for word in ("-o", setting))]


def _log_in(address: Address, common: Sequence[str], folder: Path, password: Secret | None) -> None:
    # The first setting of an option counts. Below INFO, ssh does not tell that the other side closed the connection.
    master = ["ssh", "-o", "LogLevel=INFO", *common, "-o", "ControlMaster=yes", "-o", "ControlPersist=60", "-f", "-N"]
    if password is None:
        master += ["-o", "BatchMode=yes"]
    else:
        master += ["-o", "NumberOfPasswordPrompts=1", "-o", "PubkeyAuthentication=no"]
        master += ["-o", "PreferredAuthentications=password,keyboard-interactive"]
    answering = (
        nullcontext(dict(os.environ, LC_ALL="C")) if password is None else answer_password(folder, password.reveal())
    )
    with answering as environment:
        # The process in the background keeps its standard error open: a file, since a pipe would never end.
        log = folder / "log"
        done = run_process(
            ["sh", "-c", 'exec "$@" >/dev/null 2>"$0"', str(log), *master, str(address)],
            timeout=CONNECT_SECONDS * 3,
            what=f"logging in to {address}",
            environment=environment,
        )
    if done.code:
        raise explain_failure(address, log.read_text(errors="replace"))


def lost_connection(place: str, said: str) -> UserError:
    """The error of a connection that broke."""
    reason = said.strip().splitlines()[-1] if said.strip() else "it closed"
    if reason.startswith("kex_exchange_identification"):  # the shared connection had ended before: see _ONLY_SHARED
        reason = "it closed"
    return UserError(error(f"{place}: the connection is gone: {reason}", rule="lost-connection", help=_AGAIN))


def is_expired(said: str) -> bool:
    """Whether sshd refused a command since the user has to choose a new password first."""
    return "Password change required but no TTY available" in said


def expired_password(address: Address) -> UserError:
    """The error of a computer that wants a new password at the first login, as Ubuntu's images do."""
    return UserError(
        error(
            f"{address}: its password has to be changed at the first login, expected one that lasts",
            rule="expired-password",
            help=f"run: ssh {address}; choose a password; then run this again with that one",
        )
    )


def explain_failure(address: Address, said: str) -> UserError:
    """What ssh's words mean when a login failed, and what helps."""
    lines = [line for line in said.splitlines() if line.strip()]
    last = lines[-1] if lines else "ssh said nothing"
    for pattern, rule, message, help in _FAILURES:
        if pattern in said:
            return UserError(error(f"{address}: {message}", rule=rule, help=help.format(host=address.host)))
    return UserError(error(f"{address}: no login: {last}", rule="no-login", help=_AGAIN))


_AGAIN = "check the network (ur doctor), then run this again: it goes on where it stopped"
_FAILURES = (
    (
        "IDENTIFICATION HAS CHANGED",
        "changed-host-key",
        "another host key than the one that is known, expected the same computer as before",
        "if it was flashed or replaced on purpose: ur robot setup {host} --new-host-key",
    ),
    (
        "Host key verification failed",
        "unknown-host-key",
        "its host key is not known, expected a computer that was set up",
        "run: ur robot setup {host}",
    ),
    ("Permission denied", "refused", "the login was refused", "check user and password, or run: ur robot setup {host}"),
    (
        "Could not resolve hostname",
        "unknown-host",
        "no computer answers to this name",
        "is it on, and in the same network? 'ur robots' shows who is there",
    ),
    ("timed out", "no-answer", "no answer", "is it on, and in the same network? 'ur robots' shows who is there"),
    ("No route to host", "no-answer", "no answer", "is it on, and in the same network? 'ur robots' shows who is there"),
    (
        "Connection refused",
        "no-ssh",
        "it is there and runs no ssh server",
        "there: sudo apt-get install openssh-server",
    ),
)
