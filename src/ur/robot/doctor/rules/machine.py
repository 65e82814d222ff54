"""The computers themselves: clock, disk space, memory, supply voltage, and services that fail."""

import re
from collections.abc import Iterator

from ur.robot.boot.units import PREFIX
from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import PairRule, Rule, SideRule
from ur.robot.doctor.side import Disk, Side
from ur.robot.ssh.shell import quote

KEPT = ("ssh.service", "avahi-daemon.service", "chrony.service")


def check_services(where: Where, side: Side) -> Iterator[Finding]:
    """Check for failed units; on this computer, only those that robots need."""
    for unit in side.failing:
        boot = unit.name.removesuffix(".service").removeprefix(PREFIX) if unit.name.startswith(PREFIX) else ""
        if where == "local" and not boot and unit.name not in KEPT:
            continue
        last = f"; its last output: {' / '.join(unit.last)}" if unit.last else ""
        if boot:
            yield Finding(
                "failing-boot-service",
                f"{side.name}: {unit.name}, started at boot, has ended and is started again "
                f"(so far {unit.restarts} times){last}",
                f"fix the program and install it again (ur boot install); its output: journalctl -u {unit.name}; "
                "or remove it:",
                (FixCommand("local", f"ur boot remove --robot {quote(side.name)} {quote(boot)}"),),
            )
        else:
            name = quote(unit.name)
            yield Finding(
                "failed-service",
                f"{side.name}: {unit.name} failed{last}",
                f"its output: journalctl -u {unit.name}",
                (FixCommand(where, f"systemctl restart {name} || systemctl reset-failed {name}", root=True),),
            )


CLOCK_SECONDS = 0.5  # the typical tolerance of tf
# Just after its start, chrony steps the clock by itself (makestep 1 3); later it needs a command.
STEP = "systemctl restart chrony && { chronyc waitsync 15 0.3 0 1 || chronyc makestep; }"


def check_offset(pair: ComputerPair) -> Iterator[Finding]:
    """Check whether the clocks disagree."""
    if abs(pair.offset) > CLOCK_SECONDS:
        by = f"{abs(pair.offset):.1f} s {'ahead of' if pair.offset > 0 else 'behind'}"
        yield Finding(
            "clock-offset",
            f"the clock of {pair.remote.name} is {by} the one of {pair.local.name}",
            "where it takes its time from: chronyc sources",
            (FixCommand("remote", STEP, root=True, safe=True),),
        )


def check_daemon(where: Where, side: Side) -> Iterator[Finding]:
    """Check for a running clock synchronisation."""
    state = side.active.get("chrony.service")
    if side.only_ros2 and side.active.get("systemd-timesyncd.service") == "active":
        return  # as in Ubuntu
    if state not in ("active", None) and not any(unit.name == "chrony.service" for unit in side.failing):
        installed = not side.packages or "chrony" in side.packages
        line = "systemctl enable --now chrony" if installed else "apt-get install -y chrony"
        yield Finding(
            "no-time-synchronisation",
            f"{side.name}: chrony does not run, so its clock drifts"
            + (", and robots without internet get no time from it" if where == "local" else ""),
            commands=(FixCommand(where, line, root=True, safe=True),),
        )


FULL_FREE = 200.0  # MB
FULL_USED = 0.9  # a small file system with little use is not full
MEMORY_FREE = 100.0  # MB
LARGE = 5.0  # MB; a smaller folder is not worth emptying
_NOW, _EVER = 0x1, 0x10000  # bits of the firmware's status: under-voltage now, and since boot
# On a Raspberry Pi: its own program, or the kernel's attribute.
_THROTTLED = """\
vcgencmd get_throttled 2>/dev/null || \
sed 's/^/0x/' /sys/devices/platform/soc/soc:firmware/get_throttled 2>/dev/null || \
for d in /sys/class/hwmon/hwmon*; do [ "$(cat "$d/name" 2>/dev/null)" != rpi_volt ] || \
sed 's/^/0x/' "$d/in0_lcrit_alarm"; done"""
# By folder: the command that empties it, as root or not, and whether that loses no data.
_EMPTY = {
    "/var/cache/apt": ("apt-get clean", True, True),
    "/var/log/journal": ("journalctl --rotate --vacuum-size=20M", True, True),
    ".ros/log": ("rosclean purge -y", False, False),
}


def check_disks(where: Where, side: Side) -> Iterator[Finding]:
    """Check for file systems that are nearly full."""
    for disk in side.disks:
        if disk.free < FULL_FREE and disk.used >= FULL_USED:
            large = _large_on(disk, side)
            what = ", ".join(f"{path} has {size:.0f} MB" for path, size in large)
            commands = tuple(
                FixCommand(where, line, root=root, safe=safe)
                for path, _ in large
                for end, (line, root, safe) in _EMPTY.items()
                if path.endswith(end)
            )
            yield Finding(
                "full-disk",
                f"{side.name}: {disk.free:.0f} MB are left on {disk.place}" + (f"; {what}" if what else ""),
                "" if commands else f"find large folders: sudo du -xhd 2 {disk.place} | sort -h | tail",
                commands,
            )


def _large_on(disk: Disk, side: Side) -> list[tuple[str, float]]:
    """Return folders on this file system that may be emptied, the largest first."""

    def mount_of(path: str) -> str:
        places = [each.place for each in side.disks if f"{path}/".startswith(each.place.rstrip("/") + "/")]
        return max(places, key=len, default="")

    found = [(path, size) for path, size in side.large.items() if size >= LARGE and mount_of(path) == disk.place]
    return sorted(found, key=lambda each: -each[1])


def check_memory(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check the free memory."""
    if side.memory_free is not None and side.memory_free < MEMORY_FREE:
        yield Finding(
            "low-memory",
            f"{side.name}: {side.memory_free:.0f} MB of memory are left, expected {MEMORY_FREE:.0f} MB or more",
            "end programs there; the largest: ps -eo rss,args --sort=-rss | head",
        )


def check_voltage(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check for under-voltage, as a Raspberry Pi detects it."""
    found = re.search(r"0x([0-9a-fA-F]{1,16})\b", side.observed.get("throttled", ""))
    throttled = int(found[1], 16) if found else 0
    if throttled & (_NOW | _EVER):
        when = "now" if throttled & _NOW else "since it booted, not at this moment"
        yield Finding(
            "under-voltage", f"{side.name}: its supply was too weak {when}", "a stronger supply, a shorter cable"
        )


RULES: tuple[Rule, ...] = (
    PairRule({"clock-offset": "the clocks differ, and tf refuses data"}, check_offset),
    SideRule({"no-time-synchronisation": "nothing keeps a clock right"}, check_daemon),
    SideRule({"full-disk": "hardly anything is left on a disk"}, check_disks, simulation=True),
    SideRule({"low-memory": "hardly any memory is left"}, check_memory, simulation=True),
    SideRule({"under-voltage": "the robot's supply is too weak"}, check_voltage, observe={"throttled": _THROTTLED}),
    SideRule(
        {
            "failing-boot-service": "a program that is started at boot ends again and again",
            "failed-service": "a service of the robot failed",
        },
        check_services,
    ),
)
