"""The table of known devices, and the probable type of a device. Pure, except for reading the table itself."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from ur.devices.device import Device, Kind

COLUMNS = ("id", "match", "product", "kind", "stable", "baud", "sure", "probe", "what", "source")
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
    probe: str
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
        name, match, product, kind, stable, baud, sure, probe, what, source = cells
        found = next((each for each in KINDS if each == kind), None)
        if found is None or sure not in ("yes", "no") or (baud and not baud.isdecimal()):
            raise ValueError(f"known_devices.tsv:{number}: bad kind, baud or sure")
        rows.append(
            KnownDevice(name, match, product, found, stable, int(baud or 0), sure == "yes", probe, what, source)
        )
    return tuple(rows)


@cache
def load_known() -> tuple[KnownDevice, ...]:
    """Return the table of known devices."""
    return parse_known((files(__package__) / "known_devices.tsv").read_text(encoding="utf-8"))


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
