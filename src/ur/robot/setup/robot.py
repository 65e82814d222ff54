"""From a freshly flashed robot to a ready one. Interrupted anywhere, the next run goes on."""

from __future__ import annotations

import fcntl
import os
import subprocess
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
from ur.robot.setup.lock import hold_robot
from ur.robot.setup.there import Robot, Viewer, WantedPassword, base_request, wanted_there
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.expired import renew_password
from ur.robot.ssh.guard import private_folder
from ur.robot.ssh.openssh import Address, SshShell, connect, host_key_options
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, error

BOOT_SECONDS = 180.0
AGAIN_SECONDS = 15.0
QUICK_SECONDS = 3
PAUSE_SECONDS = 0.5
CLOCK_SECONDS = 120.0
# The shadow hash and the password go in through standard input; crypt(3) knows every method of this system.
_COMPARE = """\
perl -e 'chomp(my ($user, $password) = <STDIN>); my $hash = (getpwnam $user)[1];
exit((defined $hash && length $hash > 1 && crypt($password, $hash) eq $hash) ? 0 : 1)'
"""


@dataclass(frozen=True, slots=True)
class Task:
    """One robot to be set up: where it is now, what it shall be, and the passwords that may be needed on the way.

    `current` is None when the user gave none: login by key, sudo without a password. `new` is None: the password stays.
    `library` is the copy of this project that it gets.
    """

    address: Address
    robot: Robot
    current: Secret | None = None
    new: Secret | None = None
    new_host_key: bool = False
    library: Wanted | None = None

    @property
    def later(self) -> Address:
        """Where it will be."""
        return Address(self.address.user, f"{self.robot.name}.local")


Report = Callable[[str], None]


@contextmanager
def open_robot(task: Task, report: Report) -> Iterator[SshShell]:
    """Log in to the robot: under its present name, or, where an earlier run was interrupted, under its new one."""
    with private_folder() as folder:
        first_contact = folder / "known_hosts"
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
                rule = problem.diagnostics[0].rule
                if rule in ("changed-host-key", "missing-program"):
                    raise
                if rule == "expired-password":
                    if not task.current or not task.new:
                        raise
                    report("its password has to be changed at the first login")
                    renew_password(address, task.current, task.new, host_key_options(known_hosts))
                    continue  # there are more ways in: the new password
                if rule != "refused":
                    silent[address.host] = problem
        else:
            raise silent.get(task.address.host, failure)
        try:
            if first_contact.exists():
                report(f"first contact, host key {_fingerprint(first_contact)}")
            candidates = _passwords(task)
            if not shell.find_sudo(candidates):
                raise explain_sudo(shell.address, shell.sudo_said, given=bool(candidates))
            yield shell
        finally:
            connection.__exit__(None, None, None)


def explain_sudo(address: Address, said: str, *, given: bool) -> UserError:
    """What sudo's words mean; `given` tells whether a password was tried."""
    user = address.user
    message = "sudo refuses this password" if given else "sudo wants a password"
    help = f"expected the password of {user}, who may use sudo"
    if "not in the sudoers file" in said or "may not run sudo" in said or "not allowed to" in said:
        message, help = f"{user} may not use sudo there", f"as root there: usermod --append --groups sudo {user}"
    elif "sudo: not found" in said or "sudo: command not found" in said:
        message, help = "sudo is not installed there", "as root there: apt-get install sudo"
    return UserError(error(f"{address}: {message}", rule="no-root", help=help))


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

    with _alone_here():
        bring_about(shell, make, user, base, root=False, report=lambda _: None)
    facts = gather(shell, base)
    return Viewer(user, facts.hostname, facts.file(KEY + ".pub").text or "", facts.file(HOST_KEY).text)


def preview(task: Task, shell: SshShell, viewer: Viewer) -> list[Change]:
    """What would be changed on the robot."""
    user = task.address.user
    base = base_request(user)
    items = _wanted(task, shell, viewer, gather(shell, base, root=True))
    return plan_changes(items, look(shell, items, user, base, root=True))


def _wanted(task: Task, shell: SshShell, viewer: Viewer, facts: Facts) -> list[Wanted]:
    return wanted_there(facts, task.robot, viewer, _password(task, shell), library=task.library)


def set_up(task: Task, here: Shell, viewer: Viewer, report: Report) -> int:
    """Bring the robot, and what this computer knows of it, to the wanted state; the number of changes it took.

    Raises UserError, naming what failed, what to do, and leaving a robot that can be reached.
    """
    user = task.address.user
    with open_robot(task, report) as shell, hold_robot(shell, f"{viewer.user}@{viewer.name}", report):
        _check_name_is_free(task, shell)
        set_clock(shell, time.time, report)
        facts, count = bring_about(
            shell,
            lambda facts: _wanted(task, shell, viewer, facts),
            user,
            base_request(user),
            root=True,
            report=lambda change: report(f"{change.title} ({change.note})" if change.note else change.title),
        )
        # Before the reboot: from then on the robot is known under its new name, strictly.
        count += _remember(task, here, viewer, facts, report)
        if facts.hostname == task.robot.name:
            return count
        at = shell.run('set -- $SSH_CONNECTION; echo "$3"').out.strip()
        at = shell.address.host if "%" in at else at  # an address that means something over there only
        report(f"reboot as {task.later.host}")
        _reboot(shell)
    report(f"waiting for {task.later.host}")
    wait_for_boot(task, facts.boot, at, report)
    return count + 1


def set_clock(shell: Shell, now: Callable[[], float], report: Report) -> None:
    """Set a clock that is minutes off, as that of a computer without a battery for it: apt and keys look at dates.

    `now` is this computer's time (s since 1970). Smaller differences are left to chrony. Nothing happens where the
    clock cannot be set.
    """
    said = shell.run("date +%s").out.strip()
    ahead = int(said) - now() if said.isdigit() else 0.0
    if abs(ahead) > CLOCK_SECONDS:
        days, seconds = divmod(round(abs(ahead)), 86400)
        much = f"{days} days" if days else f"{seconds} s"
        report(f"clock, which is {much} {'ahead' if ahead > 0 else 'behind'}")
        shell.run(f"date -u -s @{now():.0f}", root=True)


def wait_for_boot(
    task: Task, before: str, at: str, report: Report, clock: Callable[[], float] = time.monotonic
) -> None:
    """Wait until the robot has booted again and answers to its new name and our key. Raises UserError.

    `before` names the boot that shall end, `at` is the robot's address in it. A robot that is still in that boot did
    not hear that it shall reboot: it is told again.
    """
    # Its new name is that of its host key, which is known, whatever it still calls itself.
    old = ["-o", f"HostKeyAlias={task.later.host}", "-o", f"ConnectTimeout={QUICK_SECONDS}"]
    ways = [(task.later, list[str]()), *([(Address(task.address.user, at), old)] if at else [])]
    end, patience = clock() + BOOT_SECONDS, clock() + AGAIN_SECONDS
    reason = "it does not answer"
    while clock() < end:
        for address, options in ways:
            try:
                with connect(address, options=options) as shell:
                    said = shell.run("cat /proc/sys/kernel/random/boot_id /proc/sys/kernel/hostname").out
                    boot, _, name = said.strip().partition("\n")
                    if boot != before:
                        if name == task.robot.name and address == task.later:
                            return
                        reason = "its name leads elsewhere" if name == task.robot.name else f"it calls itself {name}"
                        continue
                    reason = "it has not gone down yet"
                    if clock() > patience and shell.find_sudo(_passwords(task)):
                        report(f"it has not gone down: reboot as {task.later.host} once more")
                        reason = _reboot(shell) or reason
                        patience = clock() + AGAIN_SECONDS
            except UserError as problem:
                reason = problem.diagnostics[0].message
        time.sleep(PAUSE_SECONDS)
    raise UserError(
        error(
            f"{task.later}: not back {BOOT_SECONDS:g} s after its reboot: {reason}",
            rule="no-boot",
            help="is it in the same network? then run this again: it goes on where it stopped",
        )
    )


def _reboot(shell: SshShell) -> str:
    """Tell it to reboot; why it refuses, if it does."""
    with suppress(UserError):  # the connection does not outlive it
        done = shell.run("systemctl reboot --no-block", root=True, timeout=20)
        return done.err.strip().splitlines()[0] if done.code and done.err.strip() else ""
    return ""


def _passwords(task: Task) -> list[Secret]:
    return [secret for secret in (task.current, task.new) if secret]


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

    with _alone_here():
        return bring_about(
            here,
            make,
            viewer.user,
            Request(viewer.user),
            root=False,
            report=lambda change: report(f"here: {change.title}"),
        )[1]


@contextmanager
def _alone_here() -> Iterator[None]:
    """While inside, no other set-up of this user changes files here, such as one for another robot at the same time."""
    folder = Path.home() / ".ssh"
    folder.mkdir(mode=0o700, exist_ok=True)
    place = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        fcntl.flock(place, fcntl.LOCK_EX)
        yield
    finally:
        os.close(place)


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
