"""The devices that a base needs, compared with those of a computer, and udev rules with stable names. Pure."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

from ur.devices.known import (
    Device,
    DeviceSnapshot,
    Expected,
    KnownDevice,
    describe_device,
    find_known,
    find_rows,
    load_known,
)

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


State = Literal["ready", "missing", "unnamed", "ambiguous", "forbidden", "busy"]
LOGIN_PROMPT = "agetty"
_BOARD_PARTS = {
    "i2c": "is the bus on (Raspberry Pi: dtparam=i2c_arm=on in config.txt; the module i2c-dev)? ur robot setup does it",
    "gpio": "has this computer a header with pins, as a Raspberry Pi has?",
}


@dataclass(frozen=True, slots=True)
class Need:
    """An expected device and the result of the search: its state, a sentence about it, and advice ('' if it is ready).

    `unnamed`: it is connected, but the name that launch files use does not lead to it.
    """

    expected: Expected
    state: State
    message: str
    help: str = ""
    device: Device | None = None


def examine(snapshot: DeviceSnapshot, expected: Sequence[Expected]) -> list[Need]:
    """Compare the expected devices with those of the computer, in the order of `expected`."""
    return [_examine(snapshot, each) for each in expected]


def list_problems(snapshot: DeviceSnapshot) -> Iterator[tuple[State, Device, str]]:
    """Yield known devices that this user may not open, or that a program other than a driver has open."""
    for device in snapshot.devices:
        if not find_known(device) or device.kind == "usb":
            continue
        if not device.allowed and not device.holders:
            yield "forbidden", device, explain_access(snapshot, device)
        for holder in device.holders:
            if holder.program in {each.program for each in snapshot.grabbers} | {LOGIN_PROMPT}:
                yield "busy", device, explain_holder(device)


def explain_access(snapshot: DeviceSnapshot, device: Device) -> str:
    """Return the command or advice that lets this user open a device."""
    if device.group in snapshot.member and device.group not in snapshot.groups:
        return f"{snapshot.user} is in the group {device.group} since this session began: log in again"
    if device.group and device.group != "root" and (device.mode or 0) & 0o060 == 0o060:
        return f"sudo usermod --append --groups {device.group} {snapshot.user}, then log in again"
    return "install the udev rules: ur robot setup (a robot), or ur devices --rules (this computer)"


def explain_holder(device: Device) -> str:
    """Return the advice for freeing a device from the program that has it open."""
    holder, unit = device.holders[0], find_unit(device)
    if unit:
        return f"sudo systemctl disable --now {unit}"
    return f"end it: {holder.program}, process {holder.pid}" + (f", of {holder.user}" if holder.user else "")


def find_unit(device: Device) -> str:
    """Return the systemd unit of the program that has a device open, if that program opens unknown devices; else ''."""
    units = {
        LOGIN_PROMPT: f"serial-getty@{device.path.rpartition('/')[2]}.service",
        "ModemManager": "ModemManager.service",
        "brltty": "brltty.service",
    }
    return next((units[holder.program] for holder in device.holders if holder.program in units), "")


def _examine(snapshot: DeviceSnapshot, expected: Expected) -> Need:
    part = "the board of sonars" if expected.part == "sonars" else f"the {expected.part}"
    if not expected.path:
        candidates = [device for device in snapshot.devices if device.kind == expected.kind]
        if not candidates:
            return Need(expected, "missing", f"no {expected.kind} is there, which {part} needs", _plug(expected))
        return _opened(snapshot, expected, candidates[0], part)
    device = next((each for each in snapshot.devices if expected.path in (each.path, *each.links)), None)
    similar = [each for each in snapshot.devices if any(row.matches(each) for row in find_rows(expected.hardware))]
    if device is None and similar:
        where = ", ".join(each.path for each in similar)
        text = f"{part} needs {expected.path}, and no such name is there; {where} may be it"
        return Need(expected, "unnamed", text, "the name comes from our udev rules: ur robot setup", similar[0])
    if device is None:
        return Need(expected, "missing", f"{part} needs {expected.path}, which is not there", _plug(expected))
    if len(similar) > 1 and expected.path not in (each.path for each in snapshot.devices):
        where = " and ".join(each.path for each in similar)
        text = f"{where} could both be {expected.path}, which {part} needs"
        return Need(expected, "ambiguous", text, "unplug the other one, or give the driver a name of by-id", device)
    return _opened(snapshot, expected, device, part)


def _opened(snapshot: DeviceSnapshot, expected: Expected, device: Device, part: str) -> Need:
    if device.holders and device.holders[0].program in (LOGIN_PROMPT, *(each.program for each in snapshot.grabbers)):
        holder = device.holders[0]
        text = f"{device.path}, which {part} needs, is in use by {holder.program} (process {holder.pid})"
        return Need(expected, "busy", text, explain_holder(device), device)
    if not device.allowed:
        text = f"{snapshot.user} may not open {device.path} (group {device.group}), which {part} needs"
        return Need(expected, "forbidden", text, explain_access(snapshot, device), device)
    name = expected.path or device.path
    return Need(expected, "ready", f"{name}: {describe_device(device)}", "", device)


def _plug(expected: Expected) -> str:
    rows = find_rows(expected.hardware)
    if expected.kind in _BOARD_PARTS:
        return _BOARD_PARTS[expected.kind]
    if not rows:
        if expected.kind == "camera":
            return "is its cable (ribbon or USB) plugged in at both ends? ur devices lists what is there"
        return "is it plugged in and powered? ur devices lists what is there"
    if rows[0].match.startswith("/"):
        return "is the serial line enabled (Raspberry Pi: enable_uart=1 and dtoverlay=disable-bt in config.txt)?"
    ids = " or ".join(dict.fromkeys(row.match for row in rows))
    return f"is it plugged in and powered? {rows[0].what}, USB id {ids}"
