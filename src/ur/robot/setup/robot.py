"""Set-up of a robot from a freshly flashed system. After an interruption, the next run continues."""

import fcntl
import os
import re
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from ur.robot.boot.units import LIBRARIES, set_base_script
from ur.robot.discovery.record import RobotRecord, records_folder, render_record
from ur.robot.setup.access_point import OFF, PASSWORD
from ur.robot.setup.change import Change
from ur.robot.setup.contact import forget_contact, note_contact
from ur.robot.setup.engine import Progress, apply_change, apply_states, gather, gather_facts, plan_changes, plan_undo
from ur.robot.setup.facts import ComputerFacts, FactsRequest
from ur.robot.setup.internet.share import share_internet
from ur.robot.setup.keys import HOST_KEY, KEY, allowed_key, known_host, own_keys
from ur.robot.setup.lock import hold_robot
from ur.robot.setup.login import Report, Task, find_passwords, is_password, open_robot
from ur.robot.setup.robot_states import ViewerFacts, WantedPassword, WantedRobot, base_request, wanted_there
from ur.robot.setup.ros2.states import restart_silent_units, wanted_on_ros2
from ur.robot.setup.wanted import Wanted, WantedFile
from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey, find_known_keys
from ur.robot.ssh.openssh import SshShell, connect
from ur.robot.ssh.shell import Shell, quote
from ur.source.diagnostic import UserError, user_error, user_error_about
from ur.system.releases import check_robot_system, parse_os_release

BOOT_SECONDS = 180.0
AGAIN_SECONDS = 15.0
QUICK_SECONDS = 3
PAUSE_SECONDS = 0.5
CLOCK_SECONDS = 120.0
# Removes a copy of this project that no boot service needs, never a clone of the user's own.
_NOTES = "~/.local/state/ubiquity_launches"
_NO_EMPTY = "rmdir ~/.local/state ~/.local 2>/dev/null"
_REMOVE_COPY = f"""\
cd && [ -e {LIBRARIES[1]}/.copy ] && ! ls /etc/systemd/system/ubiquity-*.service >/dev/null 2>&1 &&
rm -rf {LIBRARIES[1]} && echo removed"""


def prepare_viewer(shell: Shell, user: str) -> ViewerFacts:
    """Make sure that this user has ssh keys, and return the facts that a robot needs about this computer."""
    base = FactsRequest(user, files=frozenset({HOST_KEY, KEY + ".pub"}))

    def make(facts: ComputerFacts) -> list[Wanted]:
        return own_keys(user, facts.hostname, facts.file(HOST_KEY).text)

    with _alone_here():
        apply_states(shell, make, user, base, root=False, report=lambda _: None)
    facts = gather(shell, base)
    return ViewerFacts(user, facts.hostname, facts.file(KEY + ".pub").text or "", facts.file(HOST_KEY).text)


def preview(task: Task, shell: SshShell, viewer: ViewerFacts) -> list[Change]:
    """Preview the changes on the robot."""
    user = task.address.user
    base = base_request(user)
    items = _wanted(task, shell, viewer, gather(shell, base, root=True))
    return plan_changes(items, gather_facts(shell, items, user, base, root=True))


def undo_ros2(task: Task, viewer: ViewerFacts, report: Report) -> int:
    """Revert the set-up of a robot with ROS 2, on the robot and this computer; return the number of changes.

    Packages stay. The login by key is removed last. Raises UserError.
    """
    user = task.address.user
    base = base_request(user)
    with open_robot(task, report) as shell:
        items = _wanted(task, shell, viewer, gather(shell, base, root=True))
        changes = plan_undo(items, gather_facts(shell, items, user, base, root=True))
        for change in changes:
            report(f"{change.title}: taken back")
            apply_change(shell, change)
        copy = shell.run(_REMOVE_COPY).out.strip()
        shell.run(f"rm -rf {_NOTES}; {_NO_EMPTY}")
    record = Path(records_folder(os.environ), f"{task.robot.name}.yaml")
    known = record.exists()
    record.unlink(missing_ok=True)
    return len(changes) + bool(copy) + known


def _wanted(task: Task, shell: SshShell, viewer: ViewerFacts, facts: ComputerFacts) -> list[Wanted]:
    if task.robot.ros2:
        return wanted_on_ros2(facts, task.robot, viewer, _password(task, shell), library=task.library)
    check_robot_system(shell.destination, parse_os_release(facts.system))
    return wanted_there(facts, task.robot, viewer, _password(task, shell), library=task.library, devices=task.devices)


def set_up(task: Task, here: Shell, viewer: ViewerFacts, report: Report, progress: Progress | None = None) -> int:
    """Bring the robot, and this computer's knowledge of it, to the wanted state; return the number of changes.

    `progress` is called during long changes. Raises UserError, which names the failed step and the remedy; the robot
    stays reachable.
    """
    user = task.address.user
    who = f"{viewer.user}@{viewer.name}"
    with open_robot(task, report) as shell, hold_robot(shell, who, report), share_internet(shell, report) as route:
        if task.host_key:
            note_contact(task.host_key)
        _check_robot(task, shell)
        set_clock(shell, time.time, report)
        facts, count = apply_states(
            shell,
            lambda facts: _wanted(task, shell, viewer, facts),
            user,
            base_request(user),
            root=True,
            report=lambda change: report(f"{change.title} ({change.note})" if change.note else change.title),
            route=route,
            progress=progress,
        )
        # Before the reboot: from then on only the new name is accepted for the robot.
        count += _remember(task, shell.address.host, here, viewer, facts, report)
        if task.host_key:
            forget_contact(task.host_key)
        if facts.hostname == task.robot.name:
            last = restart_silent_units(shell, report) if task.robot.ros2 else update_master(task.robot, shell, report)
            return count + last
        at = shell.run('set -- $SSH_CONNECTION; echo "$3"').out.strip()
        at = shell.address.host if "%" in at else at  # an address that is valid on the remote computer only
        report(f"reboot as {task.later.host}")
        _reboot(shell)
    report(f"waiting for {task.later.host}")
    wait_for_boot(task, facts.boot, at, report)
    return count + 1


def update_master(robot: WantedRobot, shell: Shell, report: Report) -> int:
    """Set the base and variant of the robot file on a running ROS master; return 1 if they were different, else 0.

    The master is checked each time, so that an interrupted set-up is completed. A master that starts later reads the
    values at its start.
    """
    done = shell.run(quote("python3", "-I", "-c", set_base_script(seconds=0.0)), timeout=30.0)
    if done.code or "changed" not in done.out:
        return 0
    base = f"{robot.base}, variant {robot.variant}" if robot.variant else robot.base
    report(f"ROS master: base {base}; programs that run keep the former one until they are restarted")
    return 1


def set_clock(shell: Shell, now: Callable[[], float], report: Report) -> None:
    """Correct a clock that is minutes off, as without a backup battery, because apt and keys depend on dates.

    `now` returns this computer's time (s since 1970). Smaller differences are left to chrony. A clock that cannot be
    set is no error.
    """
    reported = shell.run("date +%s").out.strip()
    ahead = int(reported) - now() if re.fullmatch(r"[0-9]{1,12}", reported) else 0.0
    if abs(ahead) > CLOCK_SECONDS:
        days, seconds = divmod(round(abs(ahead)), 86400)
        much = f"{days} days" if days else f"{seconds} s"
        report(f"clock, which is {much} {'ahead' if ahead > 0 else 'behind'}")
        shell.run(f"date -u -s @{now():.0f}", root=True)


def wait_for_boot(task: Task, before: str, at: str, report: Report) -> None:
    """Wait until the robot has rebooted and answers to its new name and this computer's key. Raises UserError.

    `before` is the id of the ending boot, `at` is the robot's address in it. If the robot is still in that boot, it has
    not received the request, which is then repeated.
    """
    # The known host key is stored under the new name, even while the robot still has its old one.
    old = ["-o", f"HostKeyAlias={task.later.host}", "-o", f"ConnectTimeout={QUICK_SECONDS}"]
    ways = [(task.later, list[str]()), *([(Address(task.address.user, at), old)] if at else [])]
    end, patience = time.monotonic() + BOOT_SECONDS, time.monotonic() + AGAIN_SECONDS
    reason = "it does not answer"
    while time.monotonic() < end:
        for address, options in ways:
            try:
                with connect(address, options=options) as shell:
                    reported = shell.run("cat /proc/sys/kernel/random/boot_id /proc/sys/kernel/hostname").out
                    boot, _, name = reported.strip().partition("\n")
                    if boot != before:
                        if name == task.robot.name and address == task.later:
                            return
                        reason = (
                            "its name resolves to another computer"
                            if name == task.robot.name
                            else f"its host name is {name}"
                        )
                        continue
                    reason = "it has not shut down yet"
                    if time.monotonic() > patience and shell.find_sudo(find_passwords(task)):
                        report(f"it has not shut down: reboot as {task.later.host} once more")
                        reason = _reboot(shell) or reason
                        patience = time.monotonic() + AGAIN_SECONDS
            except UserError as problem:
                reason = problem.diagnostics[0].message
        time.sleep(PAUSE_SECONDS)
    raise user_error_about(
        task.later,
        f"not back {BOOT_SECONDS:g} s after its reboot: {reason}",
        rule="no-boot",
        help="is it in the same network? then run this again: it continues where it stopped",
    )


def _reboot(shell: SshShell) -> str:
    """Reboot the computer; return the reason if it refuses."""
    with suppress(UserError):  # the connection ends with the boot
        done = shell.run("systemctl reboot --no-block", root=True, timeout=20)
        return done.err.strip().splitlines()[0] if done.code and done.err.strip() else ""
    return ""


def _remember(task: Task, host: str, here: Shell, viewer: ViewerFacts, facts: ComputerFacts, report: Report) -> int:
    host_key, public_key = facts.file(HOST_KEY).text, facts.file(KEY + ".pub").text
    if not host_key or (task.robot_login and not public_key):
        raise user_error_about(
            task.address, "it has no ssh keys after the set-up", rule="failed-change", help="ur doctor"
        )

    # This computer stores the key with which the robot has answered, and no other that it reports.
    shown = frozenset([task.host_key]) if task.host_key else find_known_keys(host)
    if shown and HostKey(" ".join(host_key.split()[:2])) not in shown:
        raise user_error_about(
            task.address,
            "it reports another host key than the one with which it answers",
            rule="wrong-host-key",
            help="at the robot itself: sudo systemctl restart ssh; then run this again",
        )
    robot = task.robot
    ros = robot.ros2.distro if robot.ros2 else ""
    point = (facts.file(PASSWORD).text or "").strip().removesuffix(OFF)
    record = RobotRecord(robot.name, task.address.user, robot.base, robot.variant, task.robot_login, ros, point)
    path = f"~/.config/ubiquity_launches/robots/{record.name}.yaml"

    def make(_: ComputerFacts) -> list[Wanted]:
        return [
            known_host(f"host key of {robot.name}", robot.name, host_key),
            *([allowed_key(f"login from {robot.name}", public_key)] if task.robot_login and public_key else []),
            WantedFile("memory of it", path, render_record(record), mode=0o600),
        ]

    with _alone_here():
        return apply_states(
            here,
            make,
            viewer.user,
            FactsRequest(viewer.user),
            root=False,
            report=lambda change: report(f"here: {change.title}"),
        )[1]


@contextmanager
def _alone_here() -> Iterator[None]:
    """Lock out other set-ups of this user on this computer, such as one for another robot at the same time."""
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
    return WantedPassword(task.new, is_set=is_password(shell, task.new))


def _check_robot(task: Task, shell: SshShell) -> None:
    """Raise UserError if its system cannot have ROS 1, or another computer has its future name."""
    mine = gather(shell, FactsRequest(task.address.user))
    if not task.robot.ros2:
        check_robot_system(shell.destination, parse_os_release(mine.system))
    if mine.hostname == task.robot.name:
        return
    done = shell.run(f"getent ahostsv4 {quote(task.later.host)}")
    others = {line.split()[0] for line in done.out.splitlines() if line.strip()} - {*mine.addresses, "127.0.1.1"}
    if others:
        raise user_error(
            f"{task.later.host} is another computer already ({', '.join(sorted(others))}), expected a free name",
            rule="taken-name",
            help="choose another name, or rename that one",
            subject=task.later.host,
        )
