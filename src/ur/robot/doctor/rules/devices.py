"""Devices of the robot: those that its base needs, and known ones that its user may not open."""

from collections.abc import Iterator

from ur.devices.known import Device, DeviceSnapshot
from ur.devices.needs import RELOAD, State, examine, find_unit, list_problems, write_rules
from ur.devices.observe import RULES_FILE
from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand
from ur.robot.doctor.rules.registry import PairRule, Rule
from ur.robot.ssh.shell import quote

IDS: dict[State, str] = {
    "missing": "missing-device",
    "unnamed": "device-without-name",
    "ambiguous": "device-without-name",
    "forbidden": "device-refused",
    "busy": "device-in-use",
}


def check_devices(pair: ComputerPair) -> Iterator[Finding]:
    """Check the robot's devices against its base. A container has only devices that its host passes through."""
    snapshot, name = pair.devices, pair.remote.name
    if snapshot is None:
        return
    reported = set()
    for need in examine(snapshot, pair.expected):
        if need.state == "ready" or (need.state == "missing" and snapshot.container):
            continue
        if need.device:
            reported.add(need.device.path)
        commands = tuple(_commands(pair, snapshot, need.state, need.device))
        yield Finding(IDS[need.state], f"{name}: {need.message}", "" if commands else need.help, commands)
    for state, device, help in list_problems(snapshot):
        if device.path not in reported:
            commands = tuple(_commands(pair, snapshot, state, device))
            what = f"{snapshot.user} may not open" if state == "forbidden" else "another program holds"
            yield Finding(IDS[state], f"{name}: {what} {device.path}", "" if commands else help, commands)


def _commands(
    pair: ComputerPair, snapshot: DeviceSnapshot, state: State, device: Device | None
) -> Iterator[FixCommand]:
    if state == "unnamed":
        line = f"printf %s {quote(write_rules(pair.expected))} >{RULES_FILE} && {RELOAD}"
        yield FixCommand("remote", line, root=True, safe=True)
    elif state == "forbidden" and device and device.group not in ("", "root", *snapshot.member):
        line = f"usermod --append --groups {quote(device.group)} {quote(snapshot.user)}"
        yield FixCommand("remote", line, root=True, safe=True)
    elif state == "busy" and device and (unit := find_unit(device)):
        yield FixCommand("remote", f"systemctl disable --now {quote(unit)}", root=True)


RULES: tuple[Rule, ...] = (
    PairRule(
        {
            "missing-device": "a device that the robot's base needs is not plugged in",
            "device-without-name": "a device is there, without the stable name that launch files use",
            "device-refused": "the robot's user may not open a device",
            "device-in-use": "a login prompt or a modem program has a device open",
        },
        check_devices,
    ),
)
