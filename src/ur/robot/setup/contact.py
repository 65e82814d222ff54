"""First contact: the host key of a robot is checked, or confirmed by the user, before anything secret is sent.

A robot whose set-up was interrupted keeps its confirmed host key in a note on this computer, so that the same command
continues without asking again.
"""

import os
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from ur.robot.discovery.seen import seen_path
from ur.robot.ssh.address import Address
from ur.robot.ssh.host_key import HostKey, check_known, fetch_host_key, find_known_keys
from ur.source.diagnostic import user_error_about

COMPARE = "at the robot itself: ssh-keygen -lf /etc/ssh/ssh_host_ed25519_key.pub"


@dataclass(frozen=True, slots=True)
class OfferedHostKey:
    """The host key that a robot offers, before any login, and its relation to the known host keys.

    `known`: the key is the known one of the address. `confirmed`: the address is not known, but the key is known for
    the robot's later name, or from an interrupted set-up. `unknown` and `changed`: the key was not confirmed. `away`:
    the robot does not answer; the login will report the reason. `host_key` is None if it was not needed, or without an
    answer.
    """

    state: Literal["known", "confirmed", "unknown", "changed", "away"]
    host_key: HostKey | None = None

    @property
    def is_first(self) -> bool:
        """Return whether the host key was not confirmed before."""
        return self.state in ("unknown", "changed")

    @property
    def pinned(self) -> HostKey | None:
        """The host key that logins of this set-up require; None: those known to this computer."""
        return None if self.state in ("known", "away") else self.host_key


def meet(address: Address, later: Address, *, with_key: bool = False) -> OfferedHostKey:
    """Compare the host key that a robot offers with those that this computer knows, without sending a secret.

    `later` is its address after the set-up. `with_key`: fetch the key also where it is known. Raises UserError if the
    robot has no host key of a supported type.
    """
    rule = check_known(address)
    if rule == "known":
        return OfferedHostKey("known", fetch_host_key(address) if with_key else None)
    if rule not in ("unknown-host-key", "changed-host-key"):
        return OfferedHostKey("away")
    host_key = fetch_host_key(address)
    if host_key in find_known_keys(later.host) or is_noted(host_key):
        return OfferedHostKey("confirmed", host_key)
    return OfferedHostKey("changed" if rule == "changed-host-key" else "unknown", host_key)


def needs_answer(
    address: Address, contact: OfferedHostKey, *, fingerprint: str = "", new_host_key: bool = False
) -> bool:
    """Return whether the user has to confirm the host key. Raises UserError if the key is certainly wrong.

    `fingerprint` is given by the user, '' for none; with `new_host_key` the user confirms that the known key is
    obsolete.
    """
    offered = contact.host_key.fingerprint if contact.host_key else ""
    if fingerprint and contact.state != "away" and offered != fingerprint:
        raise user_error_about(
            str(address),
            f"its host key is {offered}, expected {fingerprint}",
            rule="wrong-host-key",
            help=f"another computer may answer to this name: compare with the robot's own, {COMPARE}",
        )
    if contact.state == "changed" and not (new_host_key or fingerprint):
        raise user_error_about(
            str(address),
            f"its host key is {offered}, expected the one that is known for {address.host}",
            rule="changed-host-key",
            help="it was flashed again? Then add --new-host-key, and compare the fingerprint with the robot's own, "
            f"{COMPARE}; else another computer answers to this name: nothing was sent to it",
        )
    return contact.is_first and not fingerprint


def note_contact(host_key: HostKey) -> None:
    """Store a note that the user has confirmed this host key, and that its computer accepted the present password."""
    with suppress(OSError):  # without the note, the next run asks again
        path = _note(host_key)
        path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        path.touch(mode=0o600)


def is_noted(host_key: HostKey) -> bool:
    """Return whether a note about this host key is stored."""
    return _note(host_key).exists()


def forget_contact(host_key: HostKey) -> None:
    """Remove the note: from now on the key is known under the robot's name."""
    with suppress(OSError):
        _note(host_key).unlink()


def _note(host_key: HostKey) -> Path:
    name = host_key.fingerprint.removeprefix("SHA256:").replace("/", "_")
    return seen_path(os.environ).parent / "first_contacts" / name
