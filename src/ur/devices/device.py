"""Values about the devices of a computer."""

from dataclasses import dataclass
from typing import Literal

Kind = Literal["serial", "camera", "joystick", "i2c", "gpio", "hid", "usb"]


@dataclass(frozen=True, slots=True)
class DeviceHolder:
    """A process that has a device open: its process id, program and user ('' if unknown)."""

    pid: int
    program: str
    user: str = ""


@dataclass(frozen=True, slots=True)
class Device:
    """A device file and the hardware behind it.

    Unknown texts are empty. `usb` is VENDOR:PRODUCT in hexadecimal, `port` the USB port in the kernel's notation.
    `links` are other names in /dev. `allowed`: the inspecting user may read and write it now.
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
        """The name that is the same at every USB port and after every boot; '' if there is none."""
        own = [link for link in self.links if link.count("/") == 2]
        lasting = [link for link in self.links if "/by-id/" in link]
        return [*own, *lasting, ""][0]


@dataclass(frozen=True, slots=True)
class DeviceSnapshot:
    """The devices of a computer at one moment, as one user sees them.

    `groups` are those of the inspecting session, `member` those of the next login. `complete`: the processes of all
    users were visible. `grabbers` are running programs that open unknown serial devices, such as ModemManager.
    `container`: only devices that the host passes through are visible. `ruled`: this project's udev rules are
    installed.
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
    """A device that a base needs: its purpose, its path, and its row in the table of known devices.

    `hardware` is '' if the base declares none; `path` is '' for any device of that kind, such as a camera.
    """

    part: str
    kind: Kind
    path: str = ""
    hardware: str = ""
    baud: int = 0
