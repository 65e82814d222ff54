"""Logins of the doctor: by key, by password, or at the robot's last known address."""

from __future__ import annotations

import getpass
import os
import socket
import sys
from collections.abc import Sequence
from contextlib import ExitStack

from ur.request.remote.connection import connect_robot
from ur.robot.discovery.seen import load_seen, seen_path
from ur.robot.ssh.address import Address
from ur.robot.ssh.openssh import SshShell
from ur.robot.ssh.secret import Secret
from ur.source.diagnostic import UserError


def enter_robot(stack: ExitStack, address: Address, password_from: int | None) -> tuple[SshShell, Secret | None, bool]:
    """Log in: by key, by password, or, if the name cannot be resolved, at the robot's last known address.

    Returns the shell, the password if one was needed, and whether the key was refused. Raises UserError.
    """
    try:
        return _log_in(stack, address, password_from, ())
    except UserError as problem:
        seen = load_seen(seen_path(os.environ)).get(short_name(address))
        if not seen or problem.diagnostics[0].rule not in ("unknown-host", "no-answer"):
            raise
        first = problem
    try:
        same = ("-o", f"HostKeyAlias={address.host}", "-o", "CheckHostIP=no")
        return _log_in(stack, Address(address.user, seen.address), password_from, same)
    except UserError:
        raise first from None


def _log_in(
    stack: ExitStack, address: Address, password_from: int | None, options: Sequence[str]
) -> tuple[SshShell, Secret | None, bool]:
    try:
        return stack.enter_context(connect_robot(address, options=options)), None, False
    except UserError as problem:
        password = _password(address, password_from) if problem.diagnostics[0].rule == "refused" else None
        if password is None:
            raise
        shell = stack.enter_context(connect_robot(address, password=password, options=options))
        return shell, password, True


def _password(address: Address, descriptor: int | None) -> Secret | None:
    """Return the password for a robot that refuses the key: from the terminal, or a descriptor; None without either."""
    if descriptor is not None:
        with os.fdopen(descriptor, encoding="utf-8") as stream:
            text = stream.readline().rstrip("\n")
    elif sys.stdin.isatty():
        text = getpass.getpass(f"{address} refuses our key; its password (empty: none): ")
    else:
        text = ""
    return Secret(text) if text else None


def find_sudo(remote: SshShell, password: Secret | None) -> None:
    """Find out how to become root on the robot: with the password of the login, or one that the user enters."""
    if not remote.find_sudo([password] if password else []) and sys.stdin.isatty():
        remote.find_sudo([Secret(getpass.getpass(f"password of {remote.destination}: "))])


def short_name(address: Address) -> str:
    """Return the name of a computer without its domain."""
    name = address.host.removesuffix(".local")
    return socket.gethostname().split(".")[0] if name == "localhost" else name
