"""Start of a guarded change: become root on the robot, check that no change is pending, and send the change."""

from collections.abc import Callable

from ur.robot.commit_confirm.guarded import GuardedChange, Order
from ur.robot.commit_confirm.perform import Report, RootShell, hand_over, is_doubtful, new_identity, refuse_pending
from ur.robot.setup.facts import ComputerFacts
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError, error


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
    raise UserError(
        error(
            f"{shell.destination}: {reason}, expected the password of {shell.address.user}, who may use sudo",
            rule="no-root",
            help="run this in a terminal, or give --password-from FD (with wifi: --passwords-from FD)",
            subject=shell.destination,
        )
    )


def begin_change(
    shell: RootShell, change: GuardedChange, facts: ComputerFacts, requester: str, wait: int, report: Report
) -> str:
    """Start a change on the robot, which reverts it unless it is confirmed within `wait` s; return the attempt's id.

    The id is also returned if the connection broke, so that it is unknown whether the change has started. `requester`
    is shown to other users. Raises UserError if the change did not start.
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
