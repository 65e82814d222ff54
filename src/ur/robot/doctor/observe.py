"""What is seen on one of two computers: one script, and its answer read. Both are pure."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from ur.robot.doctor.wifi import WIFI_SCRIPT, Wifi, parse_wifi
from ur.robot.ssh.shell import quote

_AVAHI = "org.freedesktop.Avahi"
_MARK = "\x1e"
UNITS = ("ssh.service", "avahi-daemon.service", "chrony.service")
SSH_PATHS = (".", ".ssh", ".ssh/authorized_keys", ".ssh/id_ed25519")
FULL_PING = 1472  # bytes: with 28 of headers, one full Ethernet frame


@dataclass(frozen=True, slots=True)
class Side:
    """One computer as it sees itself and the other. Times in s, sizes in MB; None where nothing could be seen.

    `resolves` is what the other's full name means here; `ros` the environment that nodes get; `modes` the rights of
    the files that ssh is strict about, relative to the home folder.
    """

    name: str
    addresses: tuple[str, ...] = ()
    resolves: frozenset[str] = frozenset()
    ros: Mapping[str, str] = field(default_factory=dict)
    modes: Mapping[str, int] = field(default_factory=dict)
    active: Mapping[str, str] = field(default_factory=dict)
    failed: tuple[str, ...] = ()
    announced: str = ""
    disk_free: float | None = None
    memory_free: float | None = None
    loss: float | None = None
    latency: float | None = None
    full_frames: bool | None = None
    throttled: int = 0
    messages: Mapping[str, str] = field(default_factory=dict)
    packages: frozenset[str] = frozenset()
    wifi: tuple[Wifi, ...] = ()


def observe_script(other: str) -> str:
    """The script to be run on a computer, as the user, about itself and the OTHER computer's full name."""
    name = quote(other)
    parts = [
        "mark() { printf '\\036%s\\n' \"$1\"; }; export LC_ALL=C",
        "mark name; cat /proc/sys/kernel/hostname",
        "mark addresses; ip -brief -4 address show scope global 2>/dev/null",
        f"mark resolves; timeout 8 getent ahostsv4 {name}",
        'mark ros; for v in ROS_MASTER_URI ROS_HOSTNAME ROS_IP; do eval "w=\\${$v-}"; echo "$v=$w"; done',
        f'mark modes; cd; for p in {quote(*SSH_PATHS)}; do [ ! -e "$p" ] || stat -L -c "%a $p" "$p"; done',
        f'mark active; for u in {quote(*UNITS)}; do echo "$u $(systemctl is-active $u 2>/dev/null)"; done',
        "mark failed; systemctl --failed --plain --no-legend 2>/dev/null | cut -d' ' -f1",
        f"mark announced; timeout 5 busctl call {_AVAHI} / {_AVAHI}.Server GetHostName 2>/dev/null",
        "mark disk; df -Pm / | tail -n 1",
        "mark memory; grep MemAvailable /proc/meminfo",
        f"mark ping; ping -q -c 5 -i 0.2 -W 1 {name} 2>/dev/null",
        f"mark frame; ping -q -c 2 -i 0.2 -W 1 -M do -s {FULL_PING} {name} 2>&1",
        f"mark wifi\n{WIFI_SCRIPT}",  # after the pings: the rate is that of the latest packets
        "mark throttled; vcgencmd get_throttled 2>/dev/null",
        "mark packages; dpkg-query -W -f='${db:Status-Status} ${Package} ${Version}\\n' 2>/dev/null",
        "mark end",
    ]
    return "\n".join(parts)


def parse_side(output: str) -> Side:
    """Read what the script printed; what is missing in it stays unknown."""
    parts = {name: text for name, _, text in (part.partition("\n") for part in output.split(_MARK)[1:])}
    ping = parts.get("ping", "")
    loss = re.search(r"([\d.]+)% packet loss", ping)
    times = re.search(r"= [\d.]+/([\d.]+)/", ping)
    frame = re.search(r"([\d.]+)% packet loss", parts.get("frame", ""))
    rows = (line.split() for line in parts.get("packages", "").splitlines())
    packages = {row[1]: row[2] for row in rows if len(row) == 3 and row[0] == "installed"}
    memory = re.search(r"(\d+) kB", parts.get("memory", ""))
    throttled = re.search(r"0x([0-9a-fA-F]+)", parts.get("throttled", ""))
    announced = re.search(r'"(.*)"', parts.get("announced", ""))
    disk = parts.get("disk", "").split()
    return Side(
        name=parts.get("name", "").strip(),
        addresses=tuple(re.findall(r"\b(\d+\.\d+\.\d+\.\d+)/\d+", parts.get("addresses", ""))),
        resolves=frozenset(line.split()[0] for line in parts.get("resolves", "").splitlines() if line.strip()),
        ros={
            key: value for key, _, value in (line.partition("=") for line in parts.get("ros", "").splitlines()) if value
        },
        modes={
            path: int(mode, 8) for mode, _, path in (row.partition(" ") for row in parts.get("modes", "").splitlines())
        },
        active={unit: state for unit, _, state in (row.partition(" ") for row in parts.get("active", "").splitlines())},
        failed=tuple(parts.get("failed", "").split()),
        announced=announced[1] if announced else "",
        disk_free=float(disk[3]) if len(disk) >= 6 else None,
        memory_free=int(memory[1]) / 1024 if memory else None,
        loss=float(loss[1]) / 100 if loss else None,
        latency=float(times[1]) / 1000 if times else None,
        full_frames=float(frame[1]) < 100 if frame else None,
        throttled=int(throttled[1], 16) if throttled else 0,
        messages={name: version for name, version in packages.items() if re.search(r"-msgs$", name)},
        packages=frozenset(packages),
        wifi=parse_wifi(parts.get("wifi", "")),
    )
