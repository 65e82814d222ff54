"""The begin of a guarded change: become root on the robot, while no other change is pending, and hand it over."""

from __future__ import annotations

from collections.abc import Callable

from ur.robot.commit_confirm.guarded import GuardedChange, Order
from ur.robot.commit_confirm.perform import Report, RootShell, hand_over, is_doubtful, new_identity, refuse_pending
from ur.robot.setup.facts import ComputerFacts
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, error


def become_root(shell: SshShell, given: Secret | None, ask: Callable[[], Secret] | None) -> list[Secret]:
    """Become root on the robot; return the passwords that sudo may be given from now on.

    `given` is tried first. Without it, `ask` is called if sudo wants a password; None: no user can be asked.
    Raises UserError: that is not possible, or another change is pending there.
    """
    candidates = [given] if given else []
    is_root = shell.find_sudo(candidates)
    if not is_root and not given and ask is not None:
        candidates = [ask()]
        is_root = shell.find_sudo(candidates)
    if is_root:
        refuse_pending(shell)
        return candidates
    reason = "sudo refuses this password" if candidates else "sudo wants a password"
    raise UserError(
        error(
            f"{shell.place}: {reason}, expected that of {shell.address.user}, who may use sudo",
            rule="no-root",
            help="run this in a terminal, or give --password-from FD (with wifi: --passwords-from FD)",
            subject=shell.place,
        )
    )


def begin_change(
    shell: RootShell, change: GuardedChange, facts: ComputerFacts, requester: str, wait: int, report: Report
) -> str:
    """Hand a change to the robot, which reverts it unless it is confirmed within `wait` s.

    Returns the identity of the attempt, also when the connection broke meanwhile, so that it is unknown whether it has
    begun. `requester` is who asks, for others. Raises UserError when it did not begin.
    """
    order = Order(new_identity(), requester, wait, change)
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
