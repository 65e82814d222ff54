"""The table of known devices, and the probable type of a device. Pure, except for reading the table itself."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
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


COLUMNS = ("id", "match", "product", "kind", "stable", "baud", "sure", "what", "source")
KINDS: tuple[Kind, ...] = ("serial", "camera", "joystick", "i2c", "gpio", "hid", "usb")
_NAMES = {
    "serial": "serial device",
    "camera": "camera",
    "joystick": "joystick",
    "i2c": "I2C bus",
    "gpio": "GPIO chip",
    "hid": "input device",
    "usb": "USB device",
}


@dataclass(frozen=True, slots=True)
class KnownDevice:
    """A row of the table; its columns are described at the head of known_devices.tsv. Empty values are ''."""

    id: str
    match: str
    product: str
    kind: Kind
    stable: str
    baud: int
    sure: bool
    what: str
    source: str

    def matches(self, device: Device) -> bool:
        """Return whether a device may be of this type."""
        if self.match.startswith("/"):
            return device.path == self.match
        vendor, _, product = self.match.partition(":")
        if not device.usb or device.usb.partition(":")[0] != vendor:
            return False
        if product not in ("*", device.usb.partition(":")[2]) or device.kind != self.kind:
            return False
        return not self.product or re.search(self.product, f"{device.product} {device.serial}") is not None


def parse_known(text: str) -> tuple[KnownDevice, ...]:
    """Parse the table. Raises ValueError, which names the line, if it is malformed."""
    lines = [(n, line) for n, line in enumerate(text.splitlines(), 1) if line and not line.startswith("#")]
    if not lines or tuple(lines[0][1].split("\t")) != COLUMNS:
        raise ValueError(f"known_devices.tsv: expected the columns {' '.join(COLUMNS)}")
    rows = []
    for number, line in lines[1:]:
        cells = ["" if cell == "-" else cell for cell in line.split("\t")]
        if len(cells) != len(COLUMNS):
            raise ValueError(f"known_devices.tsv:{number}: expected {len(COLUMNS)} columns, not {len(cells)}")
        name, match, product, kind, stable, baud, sure, what, source = cells
        found = next((each for each in KINDS if each == kind), None)
        if found is None or sure not in ("yes", "no") or (baud and not baud.isdecimal()):
            raise ValueError(f"known_devices.tsv:{number}: bad kind, baud or sure")
        rows.append(KnownDevice(name, match, product, found, stable, int(baud or 0), sure == "yes", what, source))
    return tuple(rows)


@cache
def load_known() -> tuple[KnownDevice, ...]:
    """Return the table of known devices."""
    return parse_known(Path(__file__).with_name("known_devices.tsv").read_text(encoding="utf-8"))


def find_known(device: Device, table: Sequence[KnownDevice] | None = None) -> tuple[KnownDevice, ...]:
    """Return the rows that may match a device, the most certain first; one that names its product excludes others."""
    rows = [row for row in (load_known() if table is None else table) if row.matches(device)]
    special = [row for row in rows if row.product]
    return tuple(sorted(special or rows, key=lambda row: not row.sure))


def describe_device(device: Device, table: Sequence[KnownDevice] | None = None) -> str:
    """Name a device in a few words, with "probably" if its id is that of a chip in many devices."""
    rows = find_known(device, table)
    own = " ".join(dict.fromkeys(f"{device.manufacturer} {device.product}".split()))
    if not rows:
        return own or _NAMES[device.kind]
    if rows[0].sure or rows[0].match.startswith("/"):
        return rows[0].what
    what = " or ".join(row.what for row in rows)
    return f"probably {what} ({own})" if own else f"probably {what}"


def find_rows(hardware: str, table: Sequence[KnownDevice] | None = None) -> tuple[KnownDevice, ...]:
    """Return the rows with a name of base files; several if a device has had several ids."""
    return tuple(row for row in (load_known() if table is None else table) if row.id == hardware)
