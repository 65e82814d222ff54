"""From a freshly flashed robot to a ready one. Interrupted anywhere, the next run goes on."""

from __future__ import annotations

import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ur.robot.record import Record, render_record
from ur.robot.setup.change import Change
from ur.robot.setup.engine import bring_about, gather, look, plan_changes
from ur.robot.setup.facts import Facts, Request
from ur.robot.setup.keys import HOST_KEY, KEY, allowed_key, known_host, own_keys
from ur.robot.setup.there import Robot, Viewer, WantedPassword, base_request, wanted_there
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.openssh import Address, SshShell, connect
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, error

BOOT_SECONDS = 180.0
# The shadow hash and the password go in through standard input; crypt(3) knows every method of this system.
_COMPARE = """\
perl -e 'chomp(my ($user, $password) = <STDIN>); my $hash = (getpwnam $user)[1];
exit((defined $hash && length $hash > 1 && crypt($password, $hash) eq $hash) ? 0 : 1)'
"""


@dataclass(frozen=True, slots=True)
class Task:
    """One robot to be set up: where it is now, what it shall be, and the passwords that may be needed on the way.

    `current` is None when the user gave none: login by key, sudo without a password. `new` is None: the password stays.
    """

    address: Address
    robot: Robot
    current: Secret | None = None
    new: Secret | None = None
    new_host_key: bool = False

    @property
    def later(self) -> Address:
        """Where it will be."""
        return Address(self.address.user, f"{self.robot.name}.local")


Report = Callable[[str], None]


@contextmanager
def open_robot(task: Task, report: Report) -> Iterator[SshShell]:
    """Log in to the robot: under its present name, or, where an earlier run was interrupted, under its new one."""
    with tempfile.TemporaryDirectory(prefix="ur-") as name:
        first_contact = Path(name) / "known_hosts"
        silent: dict[str, UserError] = {}
        for address, known_hosts, password in _ways_in(task, first_contact):
            if address.host in silent:
                continue
            try:
                connection = connect(address, password=password, known_hosts=known_hosts)
                shell = connection.__enter__()
                break
            except UserError as problem:
                failure = problem
                if problem.diagnostics[0].rule in ("changed-host-key", "missing-program"):
                    raise
                if problem.diagnostics[0].rule != "refused":
                    silent[address.host] = problem
        else:
            raise silent.get(task.address.host, failure)
        try:
            if first_contact.exists():
                report(f"first contact, host key {_fingerprint(first_contact)}")
            candidates = [secret for secret in (task.new, task.current) if secret]
            if not shell.find_sudo(candidates):
                raise UserError(
                    error(
                        f"{shell.place}: sudo refuses this password"
                        if candidates
                        else f"{shell.place}: sudo wants a password",
                        rule="no-root",
                        help=f"expected the password of {shell.address.user}, who may use sudo",
                    )
                )
            yield shell
        finally:
            connection.__exit__(None, None, None)


def _ways_in(task: Task, first_contact: Path) -> Iterator[tuple[Address, Path | None, Secret | None]]:
    known = _is_known(task.address.host) and not task.new_host_key
    known_hosts = None if known else first_contact
    yield task.address, known_hosts, None
    for password in (task.current, task.new):
        if password:
            yield task.address, known_hosts, password
    if task.later != task.address and _is_known(task.later.host):
        yield task.later, None, None


def _is_known(host: str) -> bool:
    done = subprocess.run(["ssh-keygen", "-F", host], capture_output=True, check=False)
    return done.returncode == 0


def _fingerprint(known_hosts: Path) -> str:
    done = subprocess.run(["ssh-keygen", "-l", "-f", str(known_hosts)], capture_output=True, text=True, check=False)
    words = done.stdout.split()
    return words[1] if len(words) > 1 else "unknown"


def prepare_viewer(shell: Shell, user: str) -> Viewer:
    """Make sure that this user has keys, and tell what a robot has to know."""
    base = Request(user, files=frozenset({HOST_KEY, KEY + ".pub"}))

    def make(facts: Facts) -> list[Wanted]:
        return own_keys(user, facts.hostname, facts.file(HOST_KEY).text)

    bring_about(shell, make, user, base, root=False, report=lambda _: None)
    facts = gather(shell, base)
    return Viewer(user, facts.hostname, facts.file(KEY + ".pub").text or "", facts.file(HOST_KEY).text)


def preview(task: Task, shell: SshShell, viewer: Viewer) -> list[Change]:
    """What would be changed on the robot."""
    user = task.address.user
    base = base_request(user)
    items = wanted_there(gather(shell, base, root=True), task.robot, viewer, _password(task, shell))
    return plan_changes(items, look(shell, items, user, base, root=True))


def set_up(task: Task, here: Shell, viewer: Viewer, report: Report) -> int:
    """Bring the robot, and what this computer knows of it, to the wanted state; the number of changes it took.

    Raises UserError, naming what failed, what to do, and leaving a robot that can be reached.
    """
    user = task.address.user
    with open_robot(task, report) as shell:
        _check_name_is_free(task, shell)
        facts, count = bring_about(
            shell,
            lambda facts: wanted_there(facts, task.robot, viewer, _password(task, shell)),
            user,
            base_request(user),
            root=True,
            report=lambda change: report(change.title),
        )
        # Before the reboot: from then on the robot is known under its new name, strictly.
        count += _remember(task, here, viewer, facts, report)
        if facts.hostname != task.robot.name:
            report(f"reboot as {task.later.host}")
            count += 1
            with suppress(UserError):  # the connection does not outlive it
                shell.run("systemctl reboot --no-block", root=True, timeout=20)
    if facts.hostname != task.robot.name:
        wait_for_boot(task, facts.boot)
    return count


def wait_for_boot(task: Task, before: str, clock: Callable[[], float] = time.monotonic) -> None:
    """Wait until the robot has booted again and answers to its new name and our key. Raises UserError."""
    end = clock() + BOOT_SECONDS
    reason = "it does not answer"
    while clock() < end:
        try:
            with connect(task.later) as shell:
                said = shell.run("cat /proc/sys/kernel/random/boot_id /proc/sys/kernel/hostname").out.split()
                if said[0] != before and said[1:] == [task.robot.name]:
                    return
                reason = f"it calls itself {' '.join(said[1:])}" if said[0] != before else "it has not gone down yet"
        except UserError as problem:
            reason = problem.diagnostics[0].message
        time.sleep(1.0)
    raise UserError(
        error(
            f"{task.later}: not back {BOOT_SECONDS:g} s after its reboot: {reason}",
            rule="no-boot",
            help="is it in the same network? then run this again: it goes on where it stopped",
        )
    )


def _remember(task: Task, here: Shell, viewer: Viewer, facts: Facts, report: Report) -> int:
    host_key, public_key = facts.file(HOST_KEY).text, facts.file(KEY + ".pub").text
    if not host_key or not public_key:
        raise UserError(
            error(f"{task.address}: it has no ssh keys after the set-up", rule="failed-change", help="ur doctor")
        )

    record = Record(task.robot.name, task.address.user, task.robot.base, task.robot.variant)

    def make(_: Facts) -> list[Wanted]:
        return [
            known_host(f"host key of {task.robot.name}", task.robot.name, host_key),
            allowed_key(f"login from {task.robot.name}", public_key),
            WantedFile("memory of it", f"~/.config/ubiquity_launches/robots/{record.name}.yaml", render_record(record)),
        ]

    base = Request(viewer.user)
    return bring_about(
        here, make, viewer.user, base, root=False, report=lambda change: report(f"here: {change.title}")
    )[1]


def _password(task: Task, shell: SshShell) -> WantedPassword | None:
    if task.new is None:
        return None
    given = Secret(f"{task.address.user}\n{task.new.reveal()}\n")
    return WantedPassword(task.new, is_set=shell.run(_COMPARE, root=True, stdin=given).code == 0)


def _check_name_is_free(task: Task, shell: SshShell) -> None:
    mine = gather(shell, Request(task.address.user))
    if mine.hostname == task.robot.name:
        return
    done = shell.run(f"getent ahostsv4 {quote(task.later.host)}")
    others = {line.split()[0] for line in done.out.splitlines() if line.strip()} - {*mine.addresses, "127.0.1.1"}
    if others:
        raise UserError(
            error(
                f"{task.later.host} is another computer already ({', '.join(sorted(others))}), expected a free name",
                rule="taken-name",
                help="choose another name, or rename that one",
            )
        )
