"""One connection to another computer: the OpenSSH client's master mode, so that a command takes one round trip."""

import os
import re
import subprocess
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, ExitStack, contextmanager, nullcontext, suppress
from pathlib import Path

from ur.robot.ssh.address import Address
from ur.robot.ssh.askpass import answer_password
from ur.robot.ssh.failures import NOT_STARTED, expired_password, explain_failure, is_expired, lost_connection
from ur.robot.ssh.guard import private_folder, run_guarded
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import ShellResult, quote, run_process
from ur.source.diagnostic import UserError
from ur.source.progress import Waiting, no_waiting

CONNECT_SECONDS = 10
START_SECONDS = 60  # for a booting computer, from the start of its ssh server to the first permitted login
ALIVE_SECONDS = 3
STRICT = ("-o", "StrictHostKeyChecking=yes", "-o", "ConnectTimeout=10")  # an unknown host key is an error
_READY = "ubiquity: logged in"
_SUDO_REFUSED = re.compile(r"^sudo: (\d+ incorrect|no password|a password is required)", re.MULTILINE)
# Without the shared connection, ssh would open a separate one: ten seconds without output, and without the password.
_ONLY_SHARED = ("-o", "ProxyCommand=false")


class SshShell:
    """Runs scripts on another computer. Made by `connect`, which also closes it."""

    def __init__(
        self,
        address: Address,
        options: Sequence[str],
        login_password: Secret | None = None,
        waiting: Waiting = no_waiting,
    ) -> None:
        self.address = address
        self._waiting = waiting
        self._options = options
        self._login = login_password
        self._sudo: Secret | None = None
        self._candidates: Sequence[Secret] = ()
        self.sudo_reported = ""  # why the latest try of find_sudo failed

    @property
    def destination(self) -> str:
        """The address."""
        return str(self.address)

    @property
    def words(self) -> list[str]:
        """Return the ssh command of this connection, up to the address, for programs that start ssh themselves."""
        return ["ssh", *_ONLY_SHARED, *self._options]

    def run(self, script: str, *, root: bool = False, stdin: str | Secret = "", timeout: float = 60.0) -> ShellResult:
        """Run a script with sh on the computer. With `root`, by sudo, which reads the password from the connection.

        Raises UserError if the connection has ended.
        """
        done = self._run(script, root, stdin, timeout)
        if root and done.code and _SUDO_REFUSED.search(done.err) and self.find_sudo(self._candidates):
            # The script has not started: the password was changed meanwhile
            done = self._run(script, root, stdin, timeout)
        return done

    def _run(self, script: str, root: bool, stdin: str | Secret, timeout: float) -> ShellResult:
        text = stdin.reveal() if isinstance(stdin, Secret) else stdin
        # 255 is ssh's exit code for a broken connection, so a script must not use it.
        words = self._words(f"({script}\n); code=$?; [ $code -ne 255 ] || code=254; exit $code", root)
        with self._waiting(_describe_wait(self.address)):
            done = run_process(
                words,
                stdin=Secret(self._preface(root) + text),
                timeout=timeout,
                what=f"a command on {self.destination}",
            )
        if done.code == 255:
            raise lost_connection(self.destination, done.err)
        if done.code and is_expired(done.err):
            raise expired_password(self.address)
        return done

    def start(self, script: str, *, root: bool = False) -> subprocess.Popen[str]:
        """Start an interactive script: its standard input and output are pipes. The caller ends it."""
        process = subprocess.Popen(
            self._words(script, root),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )
        assert process.stdin
        with suppress(BrokenPipeError):
            process.stdin.write(self._preface(root))
            process.stdin.flush()
        return process

    def forward_back(self, port: int) -> int:
        """Forward a port of this computer's loopback interface to the remote computer while the connection lasts.

        Return the port on the remote loopback interface; 0 if the ssh server does not allow forwarding.
        """
        done = self._forward("-R", f"127.0.0.1:0:127.0.0.1:{port}")
        port_there = done.out.strip()
        return int(port_there) if done.code == 0 and port_there.isdecimal() else 0

    def forward(self, port: int) -> bool:
        """Forward the same port of the remote loopback interface to this computer; return whether that works."""
        return self._forward("-L", f"127.0.0.1:{port}:127.0.0.1:{port}").code == 0

    def _forward(self, kind: str, ports: str) -> ShellResult:
        # Options other than the shared connection's socket have no effect here, and one of them forbids forwarding.
        shared = next(word for word in self._options if word.startswith("ControlPath="))
        words = ["ssh", "-F", "none", "-o", shared, "-O", "forward", kind, ports, "--", self.destination]
        return run_process(words, timeout=CONNECT_SECONDS, what=f"forwarding to {self.destination}")

    @property
    def accepted(self) -> frozenset[Secret]:
        """The passwords that the computer has accepted: for the login, and for sudo."""
        return frozenset(one for one in (self._login, self._sudo) if one)

    def allow(self, candidates: Sequence[Secret]) -> None:
        """Set passwords to try if sudo refuses the present one, as after a command that has changed it."""
        self._candidates = tuple(candidates)

    def _words(self, script: str, root: bool) -> list[str]:
        command = quote("sh", "-c", script)
        if root and self.address.user != "root":
            options = "-n" if self._sudo is None else "-k -S -p ''"
            command = f"LC_ALL=C sudo {options} -- {command}"
        return ["ssh", *_ONLY_SHARED, *self._options, "--", self.destination, command]

    def _preface(self, root: bool) -> str:
        """Return the input that sudo reads before the script."""
        return f"{self._sudo.reveal()}\n" if root and self._sudo else ""

    def find_sudo(self, candidates: Sequence[Secret]) -> bool:
        """Find out how sudo works: without a password, or with one of these. Return whether it works."""
        self._candidates = tuple(candidates)
        self.sudo_reported = ""
        tried = self._run("true" if self.address.user == "root" else "LC_ALL=C sudo -k -n true", False, "", 30)
        if tried.code == 0:
            self._sudo = None
            return True
        # sudo takes seconds to refuse a password: try the login password first, and the one just refused last.
        refused = self._sudo
        for candidate in sorted(candidates, key=lambda one: (one == refused, one != self._login)):
            self._sudo = candidate
            tried = self._run("true", True, "", 30)
            if tried.code == 0:
                return True
        self._sudo = None
        self.sudo_reported = tried.err
        return False


@contextmanager
def connect(
    address: Address,
    *,
    password: Secret | None = None,
    known_hosts: Path | None = None,
    options: Sequence[str] = (),
    waiting: Waiting = no_waiting,
) -> Iterator[SshShell]:
    """Log in, by key or, with `password`, by that alone; the connection ends with the context, or with this process.

    Host keys must be known: in the user's own files, or, where it is given, in the file `known_hosts` alone. `options`
    are arguments for ssh that take precedence over the default ones. `waiting` is entered around each wait for an
    answer. A computer that is booting is waited for. Raises UserError, which names the failed step: name, network, host
    key, login.
    """
    with private_folder() as folder:
        common = [*options, *_common(folder / "c"), *host_key_options(known_hosts)]
        with ExitStack() as stack:
            with waiting(_describe_wait(address)):
                _enter_once_started(stack, lambda: _share_connection(address, common, folder, password))
            yield SshShell(address, common, login_password=password, waiting=waiting)


def _enter_once_started(stack: ExitStack, share: Callable[[], AbstractContextManager[None]]) -> None:
    """Log in; while the computer boots, which refuses logins of users, try again."""
    deadline = time.monotonic() + START_SECONDS
    while True:
        try:
            stack.enter_context(share())
        except UserError as problem:  # noqa: PERF203 - each takes a second
            if problem.diagnostics[0].rule != NOT_STARTED or time.monotonic() > deadline:
                raise
            time.sleep(1.0)
        else:
            return


def _describe_wait(address: Address) -> str:
    return f"waiting for {address.host.removesuffix('.local')} to answer"


def host_key_options(known_hosts: Path | None) -> list[str]:
    """Return arguments for ssh that set the accepted host keys. See `connect`."""
    if known_hosts is None:
        return ["-o", "StrictHostKeyChecking=yes"]
    files = ["-o", f"UserKnownHostsFile={known_hosts}", "-o", "GlobalKnownHostsFile=/dev/null"]
    return [*files, "-o", "StrictHostKeyChecking=yes", "-o", "HostKeyAlgorithms=ssh-ed25519"]


def password_options() -> list[str]:
    """Return arguments for ssh that allow only password logins, with one attempt."""
    once = ["-o", "NumberOfPasswordPrompts=1", "-o", "PubkeyAuthentication=no"]
    return [*once, "-o", "PreferredAuthentications=password,keyboard-interactive"]


def _common(socket: Path) -> list[str]:
    settings = (
        f"ControlPath={socket}",
        f"ConnectTimeout={CONNECT_SECONDS}",
        f"ServerAliveInterval={ALIVE_SECONDS}",  # with the count: a broken connection is closed after 12 s
        "ServerAliveCountMax=3",
        "ForwardX11=no",
        "ForwardAgent=no",
        "ClearAllForwardings=yes",
        "PermitLocalCommand=no",
        "LogLevel=ERROR",
    )
    return ["-T", *(word for setting in settings for word in ("-o", setting))]


@contextmanager
def _share_connection(address: Address, common: Sequence[str], folder: Path, password: Secret | None) -> Iterator[None]:
    # The first setting of an option counts. Below INFO, ssh does not report that the server closed the connection.
    master = ["ssh", "-o", "LogLevel=INFO", "-o", "ControlMaster=yes", "-o", "ControlPersist=no", *common]
    master += ["-o", "BatchMode=yes"] if password is None else password_options()
    answering = (
        nullcontext(dict(os.environ, LC_ALL="C")) if password is None else answer_password(folder, password.reveal())
    )
    # A remote process has to run as long as the connection: cat, which ends by itself when the connection breaks.
    script = quote("sh", "-c", f"echo; echo {_READY}; exec cat >/dev/null")
    master += ["--", str(address), script]
    with ExitStack() as stack:
        with answering as environment:
            shared = stack.enter_context(run_guarded(master, folder / "log", environment))
            ready = shared.wait_for_line(_READY, CONNECT_SECONDS * 3)
        if not ready:
            reported = shared.log.read_text(errors="replace") if shared.log.exists() else ""
            raise (
                expired_password(address) if is_expired(reported) else explain_failure(address, reported or "timed out")
            )
        yield
