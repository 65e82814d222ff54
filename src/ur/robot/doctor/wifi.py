"""The wireless links of a computer: one script, and the parser of its output. Both are pure.

The formats are those of `iw dev DEVICE link`, `iw dev DEVICE get power_save` and of /proc/net/wireless (proc(5)).
"""

import re
from dataclasses import dataclass

from ur.source.foreign.numbers import parse_decimal

# Prints the facts of each wireless device after a line with its name; nothing without one.
WIFI_SCRIPT = """\
PATH=$PATH:/usr/sbin:/sbin; for p in /sys/class/net/*/wireless; do
[ -e "$p" ] || continue; d=${p%/wireless}; d=${d##*/}; echo "device $d"
iw dev "$d" link 2>/dev/null; iw dev "$d" get power_save 2>/dev/null; grep "^ *$d:" /proc/net/wireless 2>/dev/null
done"""


@dataclass(frozen=True, slots=True)
class WirelessLink:
    """A wireless link that is up: frequency (MHz), signal (dBm), transmit rate (Mbit/s); None if not observed."""

    device: str
    frequency: float | None = None
    signal: float | None = None
    rate: float | None = None
    power_save: bool | None = None

    @property
    def band(self) -> str:
        """The band in GHz as text; '' if the frequency is unknown."""
        if self.frequency is None:
            return ""
        return "2.4 GHz" if self.frequency < 3000 else "5 GHz" if self.frequency < 5925 else "6 GHz"


def parse_wifi(text: str) -> tuple[WirelessLink, ...]:
    """Parse the output of the script: the connected devices, in its order."""
    parts = re.split(r"^device (\S+)\n", text, flags=re.MULTILINE)[1:]
    found = (_parse_device(device, reported) for device, reported in zip(parts[::2], parts[1::2], strict=True))
    return tuple(wifi for wifi in found if wifi)


def _parse_device(device: str, reported: str) -> WirelessLink | None:
    if re.search(r"^Not connected", reported, re.MULTILINE):
        return None
    signal = _number(r"^\s*signal: (-?[\d.]+) dBm", reported)
    # Without iw: status, link quality, level. A level is in dBm if it is below 0.
    level = _number(rf"^ *{re.escape(device)}: +\S+ +\S+ +(-[\d.]+)", reported)
    save = re.search(r"^\s*Power save: (on|off)", reported, re.MULTILINE)
    frequency = _number(r"^\s*freq: ([\d.]+)", reported)
    if signal is None and level is None and frequency is None:
        return None
    return WirelessLink(
        device,
        frequency,
        level if signal is None else signal,
        _number(r"^\s*tx bitrate: ([\d.]+) MBit/s", reported),
        save[1] == "on" if save else None,
    )


def _number(pattern: str, text: str) -> float | None:
    found = re.search(pattern, text, re.MULTILINE)
    return parse_decimal(found[1]) if found else None
