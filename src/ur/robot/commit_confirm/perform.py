"""The client's side of a guarded change: begin it, send it to the robot, connect again afterwards, confirm."""

import secrets
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Protocol

from ur.robot.commit_confirm.guard import (
    BUSY,
    EARLY,
    ENDED,
    LATE,
    UNCONFIRMED,
    Ended,
    arm_script,
    confirm_script,
    parse_last,
    pending_script,
    state_script,
)
from ur.robot.commit_confirm.guarded import GuardedChange, Order, pack_order
from ur.robot.setup.facts import ComputerFacts
from ur.robot.ssh.address import Address
from ur.robot.ssh.openssh import SshShell, connect
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import Shell, ShellResult
from ur.source.diagnostic import Note, UserError, user_error, user_error_about

GRACE = 90.0  # s after the robot's own limit: it makes the change, reverts it, and its network starts again
PAUSE = 1.0
NEVER = 20.0  # s after which a robot without a record of the change has not received it
CONNECT_SECONDS = 4
Report = Callable[[str], None]


class RootShell(Shell, Protocol):
    """A shell on another computer that can become root on it."""

    def find_sudo(self, candidates: Sequence[Secret]) -> bool:
        """Return whether root access works, with one of the passwords or without a password."""


Open = Callable[[Address], AbstractContextManager[RootShell]]


@dataclass(frozen=True, slots=True)
class ChangeAddresses:
    """The robot's addresses after the change, preferred one first, and before it."""

    after: tuple[Address, ...]
    before: Address


def open_as(host: str) -> Open:
    """Return a function that connects to any address of the robot and requires the known host key of `host`."""
    settings = (f"HostKeyAlias={host}", "CheckHostIP=no", f"ConnectTimeout={CONNECT_SECONDS}")

    def open_link(address: Address) -> AbstractContextManager[RootShell]:
        return connect(address, options=[word for each in settings for word in ("-o", each)])

    return open_link


def hand_over(shell: Shell, order: Order, facts: ComputerFacts) -> None:
    """Arm the robot's guard, which starts the change a second later.

    Raises UserError. Either another change is pending or the robot could not accept this one, and nothing has changed;
    or the connection broke (see `is_doubtful`), and the result is unknown.
    """
    change = order.change
    done = shell.run(
        arm_script(order.identity, change.title), root=True, stdin=pack_order(order, facts), timeout=60 + GRACE
    )
    if done.code == BUSY:
        raise _pending(shell.destination, done.out)
    if done.code:
        reported = (done.err or done.out).strip().splitlines()
        raise user_error_about(
            shell.destination,
            f"{change.title}: the robot could not prepare to revert it, so nothing was changed: "
            f"{reported[-1] if reported else f'exit code {done.code}'}",
            rule="failed-change",
            help="fix that and run this again",
        )


def refuse_pending(shell: Shell) -> None:
    """Raise UserError, with the title of the change, while another change is pending: what was read may be reverted."""
    done = shell.run(pending_script(), root=True)
    if done.code == BUSY:
        raise _pending(shell.destination, done.out)


def _pending(destination: str, reported: str) -> UserError:
    title, by = [*reported.splitlines(), "", ""][:2]
    change = f"'{title}'" if title else "another change"
    begun = f", begun by {by}," if by else ""
    return user_error_about(
        destination,
        f"{change}{begun} is not finished, expected one change at a time",
        rule="change-pending",
        help="it is confirmed or reverted within two minutes; then run this again",
    )


def is_doubtful(problem: UserError) -> bool:
    """Return whether the connection broke while a change was sent, so that the change may have started."""
    return problem.diagnostics[0].rule in ("lost-connection", "no-answer")


def come_back(
    identity: str,
    title: str,
    addresses: ChangeAddresses,
    wait: int,
    sudo: Sequence[Secret],
    open_link: Open,
    *,
    report: Report,
    clock: Callable[[], float] = time.monotonic,
    sleep: Callable[[float], None] = time.sleep,
) -> Address:
    """Connect to the robot after the change, and confirm it; return the address that answered.

    Raises UserError if the robot has reverted the change, or cannot be reached within `wait` seconds plus GRACE.
    """
    end = clock() + wait + GRACE
    doubts: dict[Address, str] = {}
    missing = None
    while clock() < end:
        sleep(PAUSE)
        for address in dict.fromkeys((*addresses.after, addresses.before)):
            new = address in addresses.after
            try:
                with open_link(address) as link:
                    if not link.find_sudo(sudo):
                        doubts[address] = f"{address}: sudo refuses"
                        continue
                    done = link.run(confirm_script(identity) if new else state_script(identity), root=True)
            except UserError as problem:
                doubts[address] = problem.diagnostics[0].message
                continue
            ended = _read(identity, done)
            if done.code != ENDED or ended:
                missing = None
            elif missing is None:
                missing = clock()
            elif clock() > missing + NEVER:
                raise _never_begun(title, address)
            if ended and not ended.confirmed:
                raise _taken_back(title, address, ended, [doubts[each] for each in addresses.after if each in doubts])
            if ended:
                report(f"{address}: answers, confirmed")
                return address if new else addresses.after[0]
    raise user_error(
        f"{title}: {addresses.before.host} has not answered within {wait + GRACE:g} s after the change began",
        rule="not-seen-again",
        help="the robot reverts the change by itself; is this computer still in its network? if nothing else "
        "helps, switch the robot off and on: it then starts as it was before the change",
        notes=_seen(doubts.values()),
        subject=title,
    )


def _read(identity: str, done: ShellResult) -> Ended | None:
    if done.code in (EARLY, LATE):
        return None
    if done.code == ENDED:
        return parse_last(identity, done.out)
    return Ended(done.code == 0, "") if done.code == 0 else None


def _never_begun(title: str, address: Address) -> UserError:
    return user_error_about(
        title,
        f"the connection to {address} broke before the change began; nothing was changed",
        rule="lost-connection",
        help="check the network (ur doctor), then run this again",
    )


def _taken_back(title: str, address: Address, ended: Ended, doubts: Sequence[str]) -> UserError:
    return user_error(
        f"{title}: the robot reverted the change: {ended.reason}",
        rule="taken-back",
        help=f"the robot is {address} as before, and nothing is lost; fix the cause, then run this again",
        notes=_seen(doubts) if ended.reason.startswith(UNCONFIRMED) else (),
        subject=title,
    )


def _seen(doubts: Iterable[str]) -> tuple[Note, ...]:
    return tuple(Note(f"seen from here: {doubt}") for doubt in doubts)


def become_root(shell: SshShell, given: Secret | None, ask: Callable[[], Secret] | None) -> list[Secret]:
    """Become root on the robot, and return the passwords that sudo may be given from now on.

    `given` is tried first. Without it, `ask` is called if sudo requires a password; None means that no user can be
    asked. Raises UserError if root access fails, or another change is pending there.
    """
    candidates = [given] if given else []
    is_root = shell.find_sudo(candidates)
    if not is_root and not given and ask is not None:
        candidates = [ask()]
        is_root = shell.find_sudo(candidates)
    if is_root:
        refuse_pending(shell)
        return candidates
    reason = "sudo refuses this password" if candidates else "sudo requires a password"
    raise user_error(
        f"{shell.destination}: {reason}, expected the password of {shell.address.user}, who may use sudo",
        rule="no-root",
        help="run this in a terminal, or give --password-from FD (with wifi: --passwords-from FD)",
        subject=shell.destination,
    )


def begin_change(
    shell: RootShell, change: GuardedChange, facts: ComputerFacts, requester: str, wait: int, report: Report
) -> str:
    """Start a change on the robot, which reverts it unless it is confirmed within `wait` s; return the attempt's id.

    The id is also returned if the connection broke, so that it is unknown whether the change has started. `requester`
    is shown to other users. Raises UserError if the change did not start.
    """
    order = Order(secrets.token_hex(4), requester, wait, change)
    try:
        hand_over(shell, order, facts)
        report(f"{change.title}: the robot begins, and reverts it unless it is confirmed within {wait} s")
    except KeyboardInterrupt:
        report(f"{change.title}: stopped; if the robot has received it already, it reverts it within {wait} s")
        raise
    except UserError as problem:
        if not is_doubtful(problem):
            raise
        report(f"{change.title}: the connection was lost while the change was sent; looking for the robot")
    return order.identity
