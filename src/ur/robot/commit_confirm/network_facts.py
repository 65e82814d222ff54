"""A robot's networks in NetworkManager, or netplan and systemd-networkd: scripts, and the parser of their output. Pure.

The formats are those of `nmcli --terse` (nmcli(1)): fields with a colon between them, colons and backslashes escaped;
of `networkctl list`, and of wpa_cli, which escapes the names of networks.
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from ur.source.foreign.numbers import parse_integer

NETWORK_MANAGER, NETPLAN = "NetworkManager", "netplan"
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
mark netplan; command -v netplan >/dev/null && ls /etc/netplan/*.yaml 2>/dev/null
mark supplicant; ls /etc/wpa_supplicant/*.conf 2>/dev/null
links() { networkctl --no-legend --no-pager list 2>/dev/null; }; mark links; links
wlan() { links | while read -r _ w t _; do [ "$t" != wlan ] || echo "$w"; done; }
mark using; for w in $(wlan); do wpa_cli -i "$w" status 2>/dev/null | sed -n "s/^ssid=/$w:/p"; done
"""
# wpa_supplicant runs only for devices that have a network already: else one without any is started to scan.
# While its own access point is open, the robot receives no others: those that it saw before are listed.
SCAN_SCRIPT = """\
mark seen; cat /run/ur-access-point/seen 2>/dev/null ||
nmcli -t -f IN-USE,SIGNAL,FREQ,SECURITY,SSID device wifi list --rescan yes 2>/dev/null
mark air; cat /run/ur-access-point/air 2>/dev/null || for w in $(wlan); do
! nmcli -t -f DEVICE,STATE device status | grep -v :unmanaged | grep -q "^$w:" || continue
c=/run/wpa_supplicant; p=; [ -S "$c/$w" ] || { ! systemctl is-active --quiet "netplan-wpa-$w" || continue
c=/run/ur-wpa; p=$c.pid; wpa_supplicant -B -i "$w" -C "$c" -P "$p" >/dev/null; }
wpa_cli -p "$c" -i "$w" scan >/dev/null && sleep 4; wpa_cli -p "$c" -i "$w" scan_results
[ -z "$p" ] || { kill "$(cat "$p")"; rm -rf "$c"; }; done 2>/dev/null
"""


_KINDS = {"ether": "ethernet", "wlan": "wifi"}  # networkctl's to nmcli's
# In the flags of a scan: nmcli's words.
_SECURITY = {"[WPA-": "WPA1", "PSK": "WPA2", "SAE": "WPA3", "EAP": "802.1X", "WEP": "WEP", "[OWE-CCMP": "OWE"}


@dataclass(frozen=True, slots=True)
class NetworkDevice:
    """A network device: type and state in nmcli's terms; its addresses, each with a prefix length.

    `owner` is the service that manages it, of those that can be changed: NETWORK_MANAGER, NETPLAN or ''.
    """

    name: str
    kind: str
    state: str
    profile: str = ""
    addresses: tuple[str, ...] = ()
    owner: str = NETWORK_MANAGER


@dataclass(frozen=True, slots=True)
class Profile:
    """A network profile of NetworkManager; `ssid` is '' for a wired one, `device` is the one that uses it.

    A wireless network of netplan has its SSID as `uuid`, and `device` is the one that it belongs to.
    """

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
    """The networks of a robot. `running`: NetworkManager runs; `others`: other services that manage networks.

    `supplicant`: configuration files of wpa_supplicant that were written by hand.
    """

    running: bool
    devices: tuple[NetworkDevice, ...] = ()
    profiles: tuple[Profile, ...] = ()
    seen: tuple[SeenNetwork, ...] = ()
    others: tuple[str, ...] = ()
    netplan: tuple[str, ...] = ()
    supplicant: tuple[str, ...] = ()

    @property
    def wireless(self) -> NetworkDevice | None:
        """The first wireless device whose networks can be changed."""
        return next((each for each in self.devices if each.kind == "wifi" and each.owner), None)

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
        row[0].partition("@")[0]: tuple(word for word in row[2:] if "/" in word)
        for row in (line.split() for line in parts.get("addresses", "").splitlines())
        if len(row) > 2
    }
    ssids = dict(line.partition(":")[::2] for line in parts.get("ssids", "").splitlines())
    running = parts.get("running", "").strip() == "active"
    others, netplan = tuple(parts.get("others", "").split()), tuple(parts.get("netplan", "").split())
    using = {name: _unescape(ssid) for name, _, ssid in (x.partition(":") for x in parts.get("using", "").splitlines())}
    own = NETPLAN if netplan and "systemd-networkd" in others else ""
    links = (line.split() for line in parts.get("links", "").splitlines())
    rows = list(_rows(parts.get("devices", ""), 4)) or [
        [x[1], _KINDS.get(x[2], x[2]), f"{x[3]} ({x[4]})", ""] for x in links if len(x) == 5
    ]
    devices = []
    for name, kind, state, profile in rows:
        owner = NETWORK_MANAGER if running and not state.startswith("unmanaged") else own if kind != "loopback" else ""
        used = using.get(name, "") if owner == NETPLAN else profile
        devices.append(NetworkDevice(name, kind, state, used, addresses.get(name, ()), owner))
    profiles = [
        Profile(uuid, kind, device, name, ssids.get(uuid, ""))
        for uuid, kind, device, name in _rows(parts.get("profiles", ""), 4)
    ]
    own_devices = {each.name for each in devices if each.owner == NETPLAN}
    for device, _, ssid in (line.partition(":") for line in parts.get("names", "").splitlines()):
        profiles += [Profile(ssid, "802-11-wireless", device, ssid, ssid)] if device in own_devices else []
    return Networks(
        running,
        tuple(devices),
        tuple(profiles),
        seen=_merge([*_rows(parts.get("seen", ""), 5), *_parse_scan(parts.get("air", ""), set(using.values()))]),
        others=others,
        netplan=netplan,
        supplicant=tuple(parts.get("supplicant", "").split()),
    )


def _parse_scan(text: str, used: set[str]) -> Iterator[list[str]]:
    """Yield the rows of `wpa_cli scan_results` in nmcli's form: BSSID, frequency, dBm, flags, SSID, between tabs."""
    for fields in (line.split("\t") for line in text.splitlines()):
        if len(fields) == 5 and (level := parse_integer(fields[2])) is not None:
            ssid = _unescape(fields[4])
            words = {word for part, word in _SECURITY.items() if part in fields[3]}
            quality = str(min(max(2 * (level + 100), 0), 100))
            yield ["*" if ssid in used else "", quality, fields[1], " ".join(sorted(words)), ssid]


def _unescape(text: str) -> str:
    """Revert wpa_supplicant's printf_encode: quoted characters, and bytes that are not printable in hexadecimal."""
    plain = {b"n": b"\n", b"r": b"\r", b"t": b"\t", b"e": b"\x1b"}

    def decode(found: re.Match[bytes]) -> bytes:
        code = found[1]
        return bytes.fromhex(code[1:].decode()) if len(code) == 3 else plain.get(code, code)

    raw = re.sub(rb"\\(x[0-9a-fA-F]{2}|.)", decode, text.encode(errors="surrogateescape"))
    return raw.decode(errors="surrogateescape")


def _merge(rows: Iterable[list[str]]) -> tuple[SeenNetwork, ...]:
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
