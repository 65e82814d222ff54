"""Udev rules that give devices stable names and let their group open them. Pure."""

from collections.abc import Iterable, Iterator, Sequence

from ur.devices.device import Expected
from ur.devices.known import KnownDevice, find_rows, load_known

_SUBSYSTEMS = {"serial": "tty", "gpio": "gpio", "i2c": "i2c-dev"}
RELOAD = " ".join(
    [
        *("udevadm control --reload && udevadm trigger --action=change",),
        *(f"--subsystem-match={each}" for each in _SUBSYSTEMS.values()),
        "&& udevadm settle --timeout=10",
    ]
)
_HEAD = """\
# Stable names of the devices of robots. Written by ur.
# A device with an id of its own always has its name; one behind a common serial chip only where a base expects it.
"""


def write_rules(expected: Sequence[Expected] = (), table: Sequence[KnownDevice] | None = None) -> str:
    """Return the rules file for the devices of a base; equal arguments give equal texts.

    ModemManager ignores these devices, because it would send modem commands to them.
    """
    rows = [*_wanted(expected, load_known() if table is None else table)]
    return _HEAD + "".join(_rule(row) for row in rows) + "".join(_header_rule(each) for each in _on_headers(expected))


def _wanted(expected: Iterable[Expected], table: Sequence[KnownDevice]) -> Iterator[KnownDevice]:
    named = {row for each in expected for row in find_rows(each.hardware, table)}
    for row in table:
        if row.stable and not row.match.startswith("/") and (row.sure or row in named):
            yield row


def _on_headers(expected: Iterable[Expected]) -> Iterator[Expected]:
    """The chips and buses of a board's header that drivers open; Debian leaves them to root."""
    return (each for each in expected if each.kind in ("gpio", "i2c") and each.path)


def _header_rule(expected: Expected) -> str:
    name = expected.path.rpartition("/")[2]
    tests = f'SUBSYSTEM=="{_SUBSYSTEMS[expected.kind]}", KERNEL=="{name}"'
    return f'# {expected.part}\n{tests}, GROUP="dialout", MODE="0660"\n'


def _rule(row: KnownDevice) -> str:
    vendor, _, product = row.match.partition(":")
    tests = ['SUBSYSTEM=="tty"', f'ATTRS{{idVendor}}=="{vendor}"']
    if product != "*":
        tests.append(f'ATTRS{{idProduct}}=="{product}"')
    if row.product:
        word = row.product.rpartition(")")[2]
        tests.append(f'ATTRS{{serial}}=="{word}*"')
    deeds = [f'SYMLINK+="{row.stable}"', 'GROUP="dialout"', 'MODE="0660"', 'ENV{ID_MM_DEVICE_IGNORE}="1"']
    return f"# {row.what}\n{', '.join([*tests, *deeds])}\n"
