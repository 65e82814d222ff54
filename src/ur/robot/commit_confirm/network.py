"""Changes of a robot's networks, and how NetworkManager makes them. Pure."""

import ipaddress
import re
import uuid
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from ur.robot.commit_confirm.guarded import GuardedChange
from ur.robot.commit_confirm.network_facts import NetworkDevice, Networks, Profile, SeenNetwork
from ur.robot.setup.access_point import CLOSE
from ur.robot.setup.access_point_side import UUID
from ur.robot.setup.change import ChangeScript
from ur.robot.setup.facts import ComputerFacts
from ur.robot.setup.wanted import WantedScript, write_file
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import quote
from ur.source.diagnostic import UserError, user_error

PROFILES = "/etc/NetworkManager/system-connections"
# All files in which NetworkManager, and netplan behind it, store profiles. The state file lists wired devices that get
# no automatic profile: if it is not restored, a robot that depends on such a profile is unreachable.
KEPT = (
    PROFILES,
    "/run/NetworkManager/system-connections",
    "/etc/netplan",
    "/var/lib/NetworkManager/no-auto-default.state",
)
UP_SECONDS = 40  # until a network has assigned an address
NAMESPACE = uuid.UUID("6f0e1a3c-52a5-4e0c-9a0e-8d0c3a9b7f14")


@dataclass(frozen=True, slots=True)
class Addressing:
    """The IPv4 configuration of a device: an address with its prefix length, or None for DHCP."""

    address: ipaddress.IPv4Interface | None
    gateway: ipaddress.IPv4Address | None = None
    names: tuple[ipaddress.IPv4Address, ...] = ()

    def title(self, device: NetworkDevice) -> str:
        """Return the title of the change for messages."""
        return f"{self.address or 'address by DHCP'} on {device.name}"


@dataclass(frozen=True, slots=True)
class WirelessNetwork:
    """A wireless network to join. `password` is None for an open one; `band` '' means any, '2.4' or '5' is in GHz."""

    ssid: str
    password: Secret | None
    management: str
    hidden: bool = False
    band: str = ""

    @property
    def uuid(self) -> str:
        """The UUID of the network's profile, which is the same whenever the network is joined."""
        return str(uuid.uuid5(NAMESPACE, self.ssid))

    @property
    def path(self) -> str:
        """The path of the profile's file."""
        return f"{PROFILES}/ur-{self.uuid}.nmconnection"


def want_profile(wifi: WirelessNetwork) -> WantedScript:
    """Return the file of a wireless network's profile, written in any case: no script may compare the password."""

    def make(facts: ComputerFacts) -> ChangeScript:
        text = render_profile(wifi)
        return ChangeScript(write_file(facts, wifi.path, text, 0o600).script, root=True, stdin=Secret(text))

    return WantedScript(f"profile of {wifi.ssid}", f"{wifi.path}: profile of {wifi.ssid!r}", make)


def render_profile(wifi: WirelessNetwork) -> str:
    """Return the text of a keyfile (nm-settings-keyfile(5)), preferred over older profiles, which stay unchanged."""
    security = ["[wifi-security]", f"key-mgmt={wifi.management}"] if wifi.management else []
    if wifi.management in ("wpa-psk", "sae") and wifi.password:
        security.append(f"psk={_escape(wifi.password.reveal())}")
    parts = [
        ["[connection]", f"id={_escape(wifi.ssid)}", f"uuid={wifi.uuid}", "type=wifi", "autoconnect-priority=10"],
        [
            "[wifi]",
            "mode=infrastructure",
            f"ssid={''.join(f'{byte};' for byte in wifi.ssid.encode(errors='surrogateescape'))}",
            *(["hidden=true"] if wifi.hidden else []),
            *([f"band={'a' if wifi.band == '5' else 'bg'}"] if wifi.band else []),
        ],
        *([security] if security else []),
        ["[ipv4]", "method=auto"],
        ["[ipv6]", "method=auto"],
    ]
    return "# Written by ur robot wifi.\n" + "\n\n".join("\n".join(part) for part in parts) + "\n"


def _escape(text: str) -> str:
    """Escape a value for GLib's key files: backslashes, line breaks, and spaces at either end."""
    for plain, escaped in (("\\", "\\\\"), ("\n", "\\n"), ("\r", "\\r"), ("\t", "\\t")):
        text = text.replace(plain, escaped)
    body = text.strip(" ")
    if not body:
        return "\\s" * len(text)
    before, after = len(text) - len(text.lstrip(" ")), len(text) - len(text.rstrip(" "))
    return "\\s" * before + body + "\\s" * after


def choose_management(seen: SeenNetwork | None, *, with_password: bool) -> str:
    """Return NetworkManager's name for a network's key management; '' for an open network. Raises UserError.

    `seen` is None for a hidden network, for which the most common key management is returned.
    """
    if seen is None:
        return "wpa-psk" if with_password else ""
    words = seen.security.split()
    if "802.1X" in words:
        raise refused(
            f"{seen.ssid}: it asks for a user name (802.1X), expected a network with one password for all",
            "bad-network",
            "make its profile on the robot with nmcli, then choose it here with --ssid",
        )
    if not words:
        return ""
    if "WEP" in words:
        raise refused(
            f"{seen.ssid}: it is protected by WEP, which is no protection, expected WPA2 or WPA3",
            "bad-network",
            "change that in the settings of the access point",
        )
    if "OWE" in words:
        return "owe"
    return "wpa-psk" if {"WPA1", "WPA2"} & set(words) else "sae"


def check_password(ssid: str, password: Secret) -> None:
    """Raise UserError unless a password is valid (IEEE 802.11: 8 to 63 characters, or 64 hexadecimal digits)."""
    text = password.reveal()
    if not (8 <= len(text.encode()) <= 63 or re.fullmatch(r"[0-9a-fA-F]{64}", text)) or not text.isprintable():
        raise refused(
            f"{ssid}: this password has {len(text)} characters, expected 8 to 63 that can be printed",
            "bad-password",
            "",
        )


class NetworkChanges(Protocol):
    """The service that manages a robot's network, as plans of changes."""

    def join(self, wifi: WirelessNetwork, device: NetworkDevice) -> GuardedChange:
        """Plan to join a network; other networks stay, and are used where this one is out of range."""

    def forget(self, profile: Profile) -> GuardedChange:
        """Plan to forget a network; if it is in use, the robot connects to another known one."""

    def address(self, device: NetworkDevice, wanted: Addressing) -> GuardedChange:
        """Plan to configure a device's address by DHCP or statically. Raises UserError if it is in no network."""


@dataclass(frozen=True, slots=True)
class NetworkManager:
    """The networks of a robot that NetworkManager manages."""

    networks: Networks

    def join(self, wifi: WirelessNetwork, device: NetworkDevice) -> GuardedChange:
        """Write a profile, unless the robot has one and the password is not replaced, and use it."""
        known = find_profile(self.networks, wifi.ssid)
        use_known = known is not None and wifi.password is None
        wanted = () if use_known else (want_profile(wifi),)
        target = known.uuid if known and use_known else wifi.uuid
        load = [f"nmcli connection load {quote(wifi.path)}"] if wanted else []
        return _guard(self.networks, f"join {wifi.ssid}", wanted, [*load, _bring_up(target, device.name)])

    def forget(self, profile: Profile) -> GuardedChange:
        """Delete the profile."""
        title = f"forget {profile.ssid or profile.name}"
        return _guard(self.networks, title, (), [f"nmcli connection delete {quote(profile.uuid)}"])

    def address(self, device: NetworkDevice, wanted: Addressing) -> GuardedChange:
        """Modify the profile that the device uses."""
        profile = self.networks.profile(device.profile)
        if profile is None:
            raise refused(f"{device.name}: in no network ({device.state}), expected a device in use", "bad-device")
        values = {
            "ipv4.method": "manual" if wanted.address else "auto",
            "ipv4.addresses": str(wanted.address or ""),
            "ipv4.gateway": str(wanted.gateway or ""),
            "ipv4.dns": " ".join(map(str, wanted.names)),
        }
        words = [word for pair in values.items() for word in pair]
        modify = f"nmcli connection modify {quote(profile.uuid, *words)}"
        return _guard(self.networks, wanted.title(device), (), [modify, _bring_up(profile.uuid, device.name)])


def _guard(networks: Networks, title: str, wanted: tuple[WantedScript, ...], live: Sequence[str]) -> GuardedChange:
    used = [
        (each.profile, each.name)
        for each in networks.devices
        if each.profile not in ("", UUID) and each.kind in ("wifi", "ethernet")
    ]
    # A network that is out of range at the moment must not prevent the others from connecting.
    first = [f"{_bring_up(*pair)} || failed=1" for pair in used]
    again = [f"{_bring_up(*pair, wait=5)} || :" for pair in used]
    script = [
        "nmcli connection reload; failed=",
        *first,
        # A profile that NetworkManager creates automatically returns only with this file.
        '[ -n "$failed" ] || exit 0',
        "systemctl restart NetworkManager; nm-online -q -s -t 15",
        *again,
    ]
    return GuardedChange(
        title,
        wanted,
        live="\n".join(["set -e", CLOSE, *live]),
        back="\n".join(script),
        # At boot, netplan has made NetworkManager's profiles of the changed files already.
        early="! command -v netplan >/dev/null || netplan generate",
        also_kept=KEPT,
        words=tuple(live),
    )


def _bring_up(identity: str, device: str, wait: int = UP_SECONDS) -> str:
    return f"nmcli --wait {wait} connection up uuid {quote(identity)} ifname {quote(device)}"


def find_profile(networks: Networks, ssid: str) -> Profile | None:
    """Find the profile of a wireless network, by its SSID or by the name of the profile."""
    wireless = [each for each in networks.profiles if each.kind == "802-11-wireless"]
    return next((each for each in wireless if ssid == each.ssid), None) or next(
        (each for each in wireless if ssid == each.name), None
    )


def check_managed(networks: Networks, destination: str, device: NetworkDevice | None) -> None:
    """Raise UserError if neither NetworkManager nor netplan manages the device (None: any device)."""
    if any(each.owner for each in ([device] if device else networks.devices)):
        return
    what = device.name if device else "the network"
    owner = ", ".join(networks.others) or "something else"
    how = f"change it in the settings of {owner}"
    if networks.supplicant:
        owner, file = f"{owner} with {networks.supplicant[0]}", networks.supplicant[0]
        how = f"on the robot, add the network to {file} (see wpa_passphrase); then: sudo wpa_cli reconfigure"
    raise refused(
        f"{destination}: {what} is managed by {owner}, expected NetworkManager, or netplan with systemd-networkd; "
        "nothing was changed",
        "no-network-manager",
        f"{how}; or hand it to NetworkManager: sudo apt-get install network-manager",
    )


def parse_addressing(address: str | None, gateway: str | None, names: Sequence[str], *, dhcp: bool) -> Addressing:
    """Parse the addressing options.

    Raises UserError for an invalid address, a missing prefix or an unreachable gateway.
    """
    if dhcp:
        return Addressing(None, None, tuple(_parse_ip(name, "--dns") for name in names))
    text = address or ""
    try:
        interface = ipaddress.IPv4Interface(text)
        good = "/" in text and 0 < interface.network.prefixlen < 31
        good = good and interface.ip not in (interface.network.network_address, interface.network.broadcast_address)
    except ValueError:
        good = False
    if not good:
        raise refused(
            f"--address {text!r} is not a host address with a prefix length, expected for instance 192.168.1.7/24",
            "bad-address",
            "",
        )
    way = _parse_ip(gateway, "--gateway") if gateway else None
    if way is not None and way not in interface.network:
        raise refused(
            f"--gateway {way} is not in the network {interface.network}, expected one that {interface.ip} reaches",
            "bad-address",
            "",
        )
    return Addressing(interface, way, tuple(_parse_ip(name, "--dns") for name in names))


def _parse_ip(text: str, option: str) -> ipaddress.IPv4Address:
    try:
        return ipaddress.IPv4Address(text)
    except ValueError:
        raise refused(
            f"{option} {text!r} is not an IPv4 address, expected one like 192.168.1.1", "bad-address", ""
        ) from None


def refused(message: str, rule: str, help: str = "") -> UserError:
    """Return the error for a value that cannot be used."""
    return user_error(message, rule=rule, help=help or None)
