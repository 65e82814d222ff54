"""Values about the devices of a computer."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal["serial", "camera", "joystick", "i2c", "hid", "usb"]


@dataclass(frozen=True, slots=True)
class DeviceHolder:
    """A process that has a device open: its number, program and user ('' where that is not known)."""

    pid: int
    program: str
    user: str = ""


@dataclass(frozen=True, slots=True)
class Device:
    """A device file and the hardware behind it. Empty texts where nothing is known.

    `usb` is VENDOR:PRODUCT in hexadecimal, `port` the USB port that it is plugged into, as the kernel names it.
    `links` are other names in /dev. `allowed`: the user who looked may read and write it now.
    """

    path: str
    kind: Kind
    usb: str = ""
    serial: str = ""
    manufacturer: str = ""
    product: str = ""
    driver: str = ""
    port: str = ""
    links: tuple[str, ...] = ()
    mode: int | None = None
    owner: str = ""
    group: str = ""
    allowed: bool = True
    holders: tuple[DeviceHolder, ...] = ()

    @property
    def stable(self) -> str:
        """The name that stays when it is plugged into another port or after another boot; '' where there is none."""
        own = [link for link in self.links if link.count("/") == 2]
        lasting = [link for link in self.links if "/by-id/" in link]
        return [*own, *lasting, ""][0]


@dataclass(frozen=True, slots=True)
class DeviceSnapshot:
    """The devices of a computer at one moment, as one user sees them.

    `groups` are those of the session that looked, `member` those that the next login gets. `complete`: the processes of
    all users were seen. `grabbers` are programs that run and open serial devices of strangers, such as ModemManager.
    `container`: the computer shows only what its host passes on. `ruled`: our udev rules are installed.
    """

    user: str = ""
    groups: frozenset[str] = frozenset()
    member: frozenset[str] = frozenset()
    devices: tuple[Device, ...] = ()
    grabbers: tuple[DeviceHolder, ...] = ()
    complete: bool = False
    container: bool = False
    ruled: bool = False


@dataclass(frozen=True, slots=True)
class Expected:
    """A device that a base needs: for which part, where, and which row of the table of known devices it is.

    `hardware` is '' where the base declares none; `path` is '' for any device of that kind, as a camera.
    """

    part: str
    kind: Kind
    path: str = ""
    hardware: str = ""
    baud: int = 0
