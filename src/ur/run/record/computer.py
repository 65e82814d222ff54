"""Identity of this computer, which survives a change of its name or address; and identity of its present boot."""

from __future__ import annotations

import socket
from dataclasses import dataclass

_MACHINE_ID = "/etc/machine-id"
_BOOT_ID = "/proc/sys/kernel/random/boot_id"


@dataclass(frozen=True, slots=True)
class Computer:
    """A computer: `machine` is its machine-id(5), or its host name where it has none; `boot` is '' if unknown.

    The machine-id is confidential: it stays on the computer.
    """

    machine: str
    boot: str
    host: str


def read_computer(machine_id: str = _MACHINE_ID, boot_id: str = _BOOT_ID) -> Computer:
    """Read the identity of this computer."""
    host = socket.gethostname()
    machine = _read_line(machine_id)
    if machine in ("", "uninitialized"):  # before the first boot has finished, machine-id(5)
        machine = host
    return Computer(machine, _read_line(boot_id), host)


def describe_user(computer: Computer, uid: int) -> str:
    """Return the identity of a user of a computer for other computers, from which the machine-id cannot be computed."""
    from hashlib import sha256

    return sha256(f"ubiquity_launches\0{computer.machine}\0{uid}".encode()).hexdigest()[:32]


def _read_line(path: str) -> str:
    try:
        with open(path, encoding="ascii", errors="replace") as file:  # noqa: PTH123 - pathlib is slow to import
            return file.readline(256).strip()
    except OSError:
        return ""
