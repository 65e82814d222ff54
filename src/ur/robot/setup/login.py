"""The task of a set-up, and the login to its robot: by key, or by a password as long as the key is not installed."""

from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from ur.devices.known import Expected
from ur.robot.setup.contact import note_contact
from ur.robot.setup.robot_states import WantedRobot
from ur.robot.setup.wanted import Wanted
from ur.robot.ssh.address import Address
from ur.robot.ssh.expired import renew_password
from ur.robot.ssh.guard import private_folder
from ur.robot.ssh.host_key import HostKey, find_known_keys, pin_host_key
from ur.robot.ssh.openssh import SshShell, connect, host_key_options
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, user_error_about


@dataclass(frozen=True, slots=True)
class Task:
    """One robot to be set up: its present address, its wanted state, and the passwords that may be needed.

    `current` is None if the user gave none: login by key, sudo without a password. `new` None keeps the password.
    `library` is the copy of this project for the robot, and its environment; `devices` are those that its base needs.
    `host_key` is the one that logins require; None: this computer knows the robot's. `first_contact` means that the
    user has just confirmed it, and the robot gets the new password only after it has accepted the present one. With
    `robot_login` the robot may log in to this computer.
    """

    address: Address
    robot: WantedRobot
    current: Secret | None = None
    new: Secret | None = None
    host_key: HostKey | None = None
    first_contact: bool = False
    robot_login: bool = False
    library: Sequence[Wanted] = ()
    devices: tuple[Expected, ...] = ()

    @property
    def later(self) -> Address:
        """The address of the robot under its new name."""
        return Address(self.address.user, f"{self.robot.name}.local")


Report = Callable[[str], None]
# The shadow hash and the password are on standard input; crypt(3) supports every method of this system.
_COMPARE = """\
perl -e 'chomp(my ($user, $password) = <STDIN>); my $hash = (getpwnam $user)[1];
exit((defined $hash && length $hash > 1 && crypt($password, $hash) eq $hash) ? 0 : 1)'
"""


@dataclass(frozen=True, slots=True)
class _Try:
    """An attempt to log in. `pinned` is the file of the confirmed host key; None: the user's known_hosts."""

    address: Address
    pinned: Path | None
    password: Secret | None = None


@contextmanager
def open_robot(task: Task, report: Report) -> Iterator[SshShell]:
    """Log in to the robot under its present name, or under its new one if an earlier run was interrupted.

    At the first contact the new password is sent only to a robot that has accepted the present one. Raises UserError.
    """
    with private_folder() as folder:
        silent: dict[str, UserError] = {}
        tries = list(_list_tries(task, pin_host_key(folder, task.host_key) if task.host_key else None))
        while tries:
            attempt = tries.pop(0)
            if attempt.address.host in silent:
                continue
            try:
                connection = connect(attempt.address, password=attempt.password, known_hosts=attempt.pinned)
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
                    renew_password(attempt.address, task.current, task.new, host_key_options(attempt.pinned))
                    if task.host_key:
                        note_contact(task.host_key)
                    tries.insert(0, replace(attempt, password=task.new))
                elif rule != "refused":
                    silent[attempt.address.host] = problem
        else:
            raise silent.get(task.address.host) or _explain_refusal(task, failure)
        try:
            _enter_sudo(task, shell)
            yield shell
        finally:
            connection.__exit__(None, None, None)


def _explain_refusal(task: Task, failure: UserError) -> UserError:
    """Return the error of a refused login for which the new password was withheld."""
    if failure.diagnostics[0].rule != "refused" or not (task.first_contact and task.current and task.new):
        return failure
    return user_error_about(
        task.address,
        "the login was refused; the new password was not sent",
        rule="refused",
        help="check user and present password; where an earlier run has changed it, that is the new one",
    )


def _enter_sudo(task: Task, shell: SshShell) -> None:
    """Find a working login for sudo.

    Raises UserError if there is none, or the given present password is not the robot's.
    """
    candidates = find_passwords(task)
    if task.first_contact:
        candidates = [one for one in candidates if one == task.current or one in shell.accepted]
    if not shell.find_sudo(candidates):
        raise explain_sudo(shell.address, shell.sudo_reported, given=bool(candidates))
    # The login may have used this computer's key, and sudo no password, so that no password was verified.
    unproven = task.first_contact and task.current and task.new and not shell.accepted
    if unproven and task.current and not is_password(shell, task.current):
        raise user_error_about(
            shell.address,
            "it has another password than the given one, and is not sent the new one",
            rule="wrong-password",
            help="give its present password; where an earlier run has changed it, that is the new one",
        )
    shell.allow(find_passwords(task))


def is_password(shell: SshShell, password: Secret) -> bool:
    """Return whether a password is that of the user on the robot. Root compares it on the robot."""
    given = Secret(f"{shell.address.user}\n{password.reveal()}\n")
    return shell.run(_COMPARE, root=True, stdin=given).code == 0


def explain_sudo(address: Address, reported: str, *, given: bool) -> UserError:
    """Return the error for sudo's output; `given`: a password was tried."""
    user = address.user
    message = "sudo refuses this password" if given else "sudo requires a password"
    help = f"expected the password of {user}, who may use sudo"
    if "not in the sudoers file" in reported or "may not run sudo" in reported or "not allowed to" in reported:
        message, help = f"{user} may not use sudo there", f"as root there: usermod --append --groups sudo {user}"
    elif "sudo: not found" in reported or "sudo: command not found" in reported:
        message, help = "sudo is not installed there", "as root there: apt-get install sudo"
    return user_error_about(str(address), message, rule="no-root", help=help)


def _list_tries(
    task: Task, pinned: Path | None, find: Callable[[str], Collection[object]] = find_known_keys
) -> Iterator[_Try]:
    yield _Try(task.address, pinned)
    for password in find_passwords(task):
        if password == task.current or not task.first_contact:
            yield _Try(task.address, pinned, password)
    # With a confirmed host key, a computer answers to the present name, so the owner of the later name is another
    # robot.
    if pinned is None and task.later != task.address and find(task.later.host):
        yield _Try(task.later, None)


def find_passwords(task: Task) -> list[Secret]:
    """Return the passwords that may be valid on the robot at this moment."""
    return [secret for secret in (task.current, task.new) if secret]
