"""Figures of a computer from the texts of /proc and /sys. `computer_files` reads them."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass

_COOLEST, _HOTTEST = -40.0, 200.0  # degrees Celsius of a sensor that works


@dataclass(frozen=True, slots=True)
class ComputerTexts:
    """Texts of files, "" for a missing file. `zones` are types and temperatures (thousandths of a degree)."""

    stat: str = ""
    meminfo: str = ""
    loadavg: str = ""
    uptime: str = ""
    wireless: str = ""
    zones: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Wireless:
    """A wireless interface: its signal in dBm, and its quality, with most drivers out of 70."""

    name: str
    signal: float
    quality: float


@dataclass(frozen=True, slots=True)
class CpuTimes:
    """The processor time since boot in ticks: total, and idle."""

    total: int = 0
    rest: int = 0


def read_times(stat: str) -> CpuTimes:
    """Read the times of /proc/stat; zero if it is malformed."""
    match = re.match(r"cpu +((?:\d{1,18} ?)+)", stat)
    numbers = [int(each) for each in match[1].split()[:8]] if match else []
    return CpuTimes(sum(numbers), sum(numbers[3:5])) if len(numbers) >= 5 else CpuTimes()


def share_used(before: CpuTimes, after: CpuTimes) -> float | None:
    """Return the share of all processors that was used between two readings; None if no time has passed."""
    total = after.total - before.total
    return min(1.0, max(0.0, 1.0 - (after.rest - before.rest) / total)) if total > 0 and before.total else None


def describe_computer(texts: ComputerTexts) -> dict[str, object]:
    """Return all known figures except processor time and disk, in bytes, s, degrees Celsius and dBm."""
    found: dict[str, object] = {}
    memory = {name: int(size) * 1024 for name, size in re.findall(r"^(\w+): +(\d{1,15}) kB$", texts.meminfo, re.M)}
    if {"MemTotal", "MemAvailable"} <= memory.keys():
        found["memory"] = [memory["MemTotal"] - memory["MemAvailable"], memory["MemTotal"]]
    if (load := _number(texts.loadavg)) is not None:
        found["load"] = load
    if (uptime := _number(texts.uptime)) is not None:
        found["uptime"] = round(uptime)
    degrees = [(name.strip()[:40], _number(text)) for name, text in texts.zones[:32]]
    good = [(name, each / 1000) for name, each in degrees if each is not None and _COOLEST < each / 1000 < _HOTTEST]
    if good:
        found["temperatures"] = [[name, round(each, 1)] for name, each in good]
    wireless = read_wireless(texts.wireless)
    if wireless:
        found["wireless"] = [[each.name, each.signal, each.quality] for each in wireless]
    return found


def read_wireless(text: str) -> list[Wireless]:
    """Read the interfaces of /proc/net/wireless. Older drivers report the signal as a byte, which is dBm + 256."""
    found = []
    for name, quality, signal in re.findall(r"^ *([\w.-]{1,15}): +\S+ +(-?[\d.]+) +(-?[\d.]+)", text, re.M):
        level, share = _number(signal), _number(quality)
        if level is not None and share is not None:
            found.append(Wireless(name, level - 256 if level > 0 else level, share))
    return found


def _number(text: str) -> float | None:
    try:
        number = float(text.split()[0].rstrip("."))
    except (ValueError, IndexError):
        return None
    return number if math.isfinite(number) else None


LEVELS: Mapping[int, str] = {0: "ok", 1: "warn", 2: "error", 3: "stale"}
"""Of diagnostic_msgs/DiagnosticStatus, by its number."""
