"""Failures of ssh, explained from its output: failed logins, and broken connections."""

from ur.robot.ssh.address import Address
from ur.source.diagnostic import UserError, user_error_about

NOT_STARTED = "not-started"
"""The rule of a computer that boots or is about to stop."""


def lost_connection(destination: str, reported: str) -> UserError:
    """Return the error for a broken connection."""
    reason = reported.strip().splitlines()[-1] if reported.strip() else "it closed"
    if reason.startswith("kex_exchange_identification"):  # the shared connection had ended before: see _ONLY_SHARED
        reason = "it closed"
    return user_error_about(destination, f"the connection has ended: {reason}", rule="lost-connection", help=_AGAIN)


def is_expired(reported: str) -> bool:
    """Return whether sshd refused a command because the user has to change the password first."""
    return "Password change required but no TTY available" in reported


def expired_password(address: Address) -> UserError:
    """Return the error for a computer that requires a new password at the first login, as Ubuntu's images do."""
    return user_error_about(
        str(address),
        "its password has to be changed at the first login, expected one that lasts",
        rule="expired-password",
        help=f"run: ssh {address}; choose a password; then run this again with that one",
    )


def explain_failure(address: Address, reported: str) -> UserError:
    """Explain ssh's output after a failed login, with a fix."""
    lines = [line for line in reported.splitlines() if line.strip()]
    last = lines[-1] if lines else "ssh printed nothing"
    for pattern, rule, message, help in _FAILURES:
        if pattern in reported:
            return user_error_about(str(address), message, rule=rule, help=help.format(host=address.host))
    return user_error_about(str(address), f"no login: {last}", rule="no-login", help=_AGAIN)


_AGAIN = "check the network (ur doctor), then run this again: it continues where it stopped"
_FAILURES = (
    (
        "IDENTIFICATION HAS CHANGED",
        "changed-host-key",
        "another host key than the one that is known, expected the same computer as before",
        "if it was flashed or replaced on purpose: ur robot setup {host} --new-host-key; "
        "else another computer answers to this name: do not log in to it",
    ),
    (
        "Host key verification failed",
        "unknown-host-key",
        "its host key is not known, expected a computer that was set up",
        "run: ur robot setup {host}",
    ),
    (
        "pam_nologin(8)",
        NOT_STARTED,
        "it is starting or about to stop, and takes no logins",
        "wait a minute, then run this again: it continues where it stopped",
    ),
    ("Permission denied", "refused", "the login was refused", "check user and password, or run: ur robot setup {host}"),
    (
        "Could not resolve hostname",
        "unknown-host",
        "no computer answers to this name",
        "is it on, and in the same network? 'ur robots' lists the robots that answer",
    ),
    (
        "timed out",
        "no-answer",
        "no answer",
        "is it on, and in the same network? 'ur robots' lists the robots that answer",
    ),
    (
        "No route to host",
        "no-answer",
        "no answer",
        "is it on, and in the same network? 'ur robots' lists the robots that answer",
    ),
    (
        "Connection refused",
        "no-ssh",
        "it answers, but runs no ssh server",
        "there: sudo apt-get install openssh-server",
    ),
)
