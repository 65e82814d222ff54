"""A robot's networks in NetworkManager: one script, and the parser of its output. Both are pure.

The format is that of `nmcli --terse` (nmcli(1)): fields with a colon between them, colons and backslashes escaped.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ur.source.foreign.numbers import parse_integer

_MARK = "\x1e"
# Profiles and passwords are readable by root only; the address of the ssh client shows which device leads to it.
FACTS_SCRIPT = """\
mark() { printf '\\036%s\\n' "$1"; }; export LC_ALL=C.UTF-8
mark running; command -v nmcli >/dev/null && systemctl is-active NetworkManager
mark devices; nmcli -t -f DEVICE,TYPE,STATE,CON-UUID device status 2>/dev/null
mark profiles; nmcli -t -f UUID,TYPE,DEVICE,NAME connection show 2>/dev/null
mark ssids; for u in $(nmcli -t -f UUID,TYPE connection show 2>/dev/null | sed -n 's/:802-11-wireless$//p'); do
printf '%s:' "$u"; nmcli -e no -g 802-11-wireless.ssid connection show "$u"; done
mark addresses; ip -brief address 2>/dev/null
mark others; for u in systemd-networkd dhcpcd networking connman; do systemctl is-active --quiet $u && echo $u; done
mark netplan; ls /etc/netplan/*.yaml 2>/dev/null
"""
SCAN_SCRIPT = """\
mark seen; nmcli -t -f IN-USE,SIGNAL,FREQ,SECURITY,SSID device wifi list --rescan yes 2>/dev/null
"""


@dataclass(frozen=True, slots=True)
class NetworkDevice:
    """A network device: type and state in nmcli's terms; its addresses, each with a prefix length."""

    name: str
    kind: str
    state: str
    profile: str = ""
    addresses: tuple[str, ...] = ()

    @property
    def managed(self) -> bool:
        """Return whether NetworkManager manages the device."""
        return not self.state.startswith("unmanaged")


@dataclass(frozen=True, slots=True)
class Profile:
    """A network profile of NetworkManager; `ssid` is '' for a wired one, `device` is the one that uses it."""

    uuid: str
    kind: str
    device: str
    name: str
    ssid: str = ""


@dataclass(frozen=True, slots=True)
class SeenNetwork:
    """A wireless network in range: signal in %, its bands, nmcli's term for its security ('' for an open one)."""

    ssid: str
    signal: int
    bands: tuple[str, ...]
    security: str
    used: bool = False


@dataclass(frozen=True, slots=True)
class Networks:
    """The networks of a robot. `running`: NetworkManager runs; `others`: other services that manage networks."""

    running: bool
    devices: tuple[NetworkDevice, ...] = ()
    profiles: tuple[Profile, ...] = ()
    seen: tuple[SeenNetwork, ...] = ()
    others: tuple[str, ...] = ()
    netplan: tuple[str, ...] = ()

    @property
    def wireless(self) -> NetworkDevice | None:
        """The first wireless device that NetworkManager may use."""
        return next((each for each in self.devices if each.kind == "wifi" and each.managed), None)

    def device_with(self, address: str) -> NetworkDevice | None:
        """The device that has this address, or None."""
        bare = address.partition("%")[0]
        return next((each for each in self.devices if bare in (one.split("/")[0] for one in each.addresses)), None)

    def profile(self, uuid: str) -> Profile | None:
        """The profile with this UUID, or None."""
        return next((each for each in self.profiles if each.uuid == uuid), None)


def parse_networks(output: str) -> Networks:
    """Parse the output of the scripts; a missing section is empty."""
    parts = {name: text for name, _, text in (part.partition("\n") for part in output.split(_MARK)[1:])}
    addresses = {
        row[0].partition("@")[0]: tuple(row[2:])
        for row in (line.split() for line in parts.get("addresses", "").splitlines())
        if len(row) > 2
    }
    ssids = dict(line.partition(":")[::2] for line in parts.get("ssids", "").splitlines())
    return Networks(
        running=parts.get("running", "").strip() == "active",
        devices=tuple(
            NetworkDevice(name, kind, state, profile, addresses.get(name, ()))
            for name, kind, state, profile in _rows(parts.get("devices", ""), 4)
        ),
        profiles=tuple(
            Profile(uuid, kind, device, name, ssids.get(uuid, ""))
            for uuid, kind, device, name in _rows(parts.get("profiles", ""), 4)
        ),
        seen=_merge(_rows(parts.get("seen", ""), 5)),
        others=tuple(parts.get("others", "").split()),
        netplan=tuple(parts.get("netplan", "").split()),
    )


def _merge(rows: Iterator[list[str]]) -> tuple[SeenNetwork, ...]:
    """Merge the access points of each SSID: the one in use and the strongest signal first.

    Hidden networks are left out.
    """
    found: dict[str, SeenNetwork] = {}
    for used, signal, frequency, security, ssid in rows:
        if not ssid:
            continue
        known = found.get(ssid)
        bands = {*(known.bands if known else ()), _band(frequency)}
        strength = parse_integer(signal) or 0
        found[ssid] = SeenNetwork(
            ssid,
            max(strength, known.signal if known else 0),
            tuple(sorted(bands)),
            "" if security == "--" else security,
            used == "*" or bool(known and known.used),
        )
    return tuple(sorted(found.values(), key=lambda one: (not one.used, -one.signal, one.ssid)))


def _band(frequency: str) -> str:
    number = parse_integer(frequency.partition(" ")[0])
    if number is None:
        return ""
    return "2.4 GHz" if number < 3000 else "5 GHz" if number < 5925 else "6 GHz"


def _rows(text: str, count: int) -> Iterator[list[str]]:
    for line in text.splitlines():
        fields = split_terse(line)
        if len(fields) == count:
            yield fields


def split_terse(line: str) -> list[str]:
    """Split a line of `nmcli --terse` into fields."""
    fields = re.findall(r"(?:^|(?<=:))(?:\\.|[^:\\])*", line)
    return [re.sub(r"\\(.)", r"\1", field) for field in fields]
