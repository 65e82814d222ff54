"""Changes of a robot's networks by netplan and systemd-networkd. Pure."""

import base64
import json
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from ur.robot.commit_confirm import netplan_side
from ur.robot.commit_confirm.guarded import GuardedChange
from ur.robot.commit_confirm.network import UP_SECONDS, Addressing, WirelessNetwork, refused
from ur.robot.commit_confirm.network_facts import NetworkDevice, Networks, Profile
from ur.robot.setup.access_point import CLOSE
from ur.robot.setup.change import ChangeScript
from ur.robot.setup.wanted import WantedScript
from ur.robot.ssh.secret import Secret
from ur.robot.ssh.shell import quote

# An error message of netplan quotes the line, which may hold a password: only its first part is printed.
_APPLY = """\
said=$(netplan generate 2>&1) || { printf '%s\\n' "$said" | sed -n 's/.*: Error/netplan: Error/p'; exit 1; }
systemctl daemon-reload; netplan apply"""
_AGAIN = "netplan generate; systemctl daemon-reload; netplan apply"
# A slow robot needs seconds for each look.
_LATEST = f"now() {{ cut -d. -f1 /proc/uptime; }}; end=$(($(now) + {UP_SECONDS}))"
# At boot, a device that had no network before has no job to start its wpa_supplicant.
_KEEP = """\
TO=/etc sh step0 <step0.in && netplan generate && systemctl daemon-reload || exit
for u in /run/systemd/system/*.wants/netplan-wpa-*; do [ ! -e "$u" ] || systemctl --no-block start "${u##*/}"; done"""


def side_command(*arguments: str) -> str:
    """Return the command that runs netplan_side on a robot."""
    source = base64.b64encode(zlib.compress(Path(netplan_side.__file__).read_bytes())).decode()
    return quote(
        "python3", "-I", "-c", f"import base64,zlib;exec(zlib.decompress(base64.b64decode('{source}')))", *arguments
    )


@dataclass(frozen=True, slots=True)
class Netplan:
    """The networks of a robot that netplan and systemd-networkd manage."""

    networks: Networks

    def join(self, wifi: WirelessNetwork, device: NetworkDevice) -> GuardedChange:
        """Plan to join a network, which is preferred from now on; the others stay."""
        if not wifi.ssid.isprintable():
            raise refused(f"{wifi.ssid!r}: netplan takes no such name, expected printable text", "bad-network")
        known = any(each.device == device.name and each.ssid == wifi.ssid for each in self.networks.profiles)
        point = None if known and wifi.password is None else _access_point(wifi)
        shown = _shown(wifi.ssid)
        order = {"device": device.name, "ssid": wifi.ssid, "point": point, "shown": shown}
        wait = [
            f"w={quote(f'wpa_cli -i {device.name}')}; {_LATEST}",
            'joined() { s=$($w status); s=$($w get_network "$(printf "%s\\n" "$s" | sed -n "s/^id=//p")" ssid)',
            f'[ "$(printf %s "$s" | base64 -w 0)" = {shown} ] && $w status | grep -qx wpa_state=COMPLETED && ',
            f"ip -4 -o address show dev {quote(device.name)} scope global | grep -q inet; }}",
            "until joined; do [ $(now) -lt $end ] || {",
            f"why='it has not joined within {UP_SECONDS} s'",
            "! $w list_networks | grep -q TEMP-DISABLED || why='the network refuses the password'",
            'echo "$why"; exit 4; }; sleep 1; done',
        ]
        return _guard(f"join {wifi.ssid}", order, device.name, "\n".join(wait))

    def forget(self, profile: Profile) -> GuardedChange:
        """Plan to forget a network, in whichever file of netplan it is."""
        return _guard(f"forget {profile.ssid}", {"device": profile.device, "forget": profile.ssid}, profile.device, ":")

    def address(self, device: NetworkDevice, wanted: Addressing) -> GuardedChange:
        """Plan to configure a device's address by DHCP or statically, over what other files define."""
        if device.kind not in ("ethernet", "wifi"):
            raise refused(f"{device.name} is a {device.kind}, expected ethernet or wifi", "bad-device")
        metric = "600" if device.kind == "wifi" else "100"
        definition: dict[str, object] = {"optional": "true"}
        if wanted.names:
            definition["nameservers"] = {"addresses": [str(name) for name in wanted.names]}
        if wanted.address is None:
            definition |= {"dhcp4": "true", "dhcp4-overrides": {"route-metric": metric}}
            found = "scope global dynamic | grep -q inet"
        else:
            definition |= {"dhcp4": "false", "addresses": [str(wanted.address)]}
            if wanted.gateway:
                definition["routes"] = [{"to": "0.0.0.0/0", "via": str(wanted.gateway), "metric": metric}]
            found = f"| grep -qF {quote(f' {wanted.address} ')}"
        until = f"{_LATEST}; until ip -4 -o address show dev {quote(device.name)} {found}; do"
        late = f"{{ echo 'no address within {UP_SECONDS} s'; exit 4; }}"
        wait = f"{until} [ $(now) -lt $end ] || {late}; sleep 1; done"
        return _guard(wanted.title(device), {"device": device.name, "address": definition}, device.name, wait)


def _guard(title: str, order: Mapping[str, object], device: str, wait: str) -> GuardedChange:
    script = ChangeScript(side_command(), root=True, stdin=Secret(json.dumps(order)))  # it may hold a password
    return GuardedChange(
        title,
        (WantedScript(title, f"/etc/netplan/{netplan_side.OURS}: {title}", lambda _: script),),
        live=f"set -e\n{CLOSE}\n{_APPLY}\n{wait}",
        back=_AGAIN,
        commit=_KEEP,
        also_kept=("/run/netplan", f"/run/systemd/system/netplan-wpa-{device}.service.d"),
        words=("netplan generate; netplan apply: for good only once this is confirmed",),
    )


def _access_point(wifi: WirelessNetwork) -> dict[str, object]:
    if wifi.management == "owe":
        raise refused(f"{wifi.ssid}: it has no password and is encrypted (OWE), unknown to netplan", "bad-network")
    password = wifi.password.reveal() if wifi.password else ""
    point: dict[str, object] = {"password": password} if password else {}
    if wifi.management == "sae":
        point = {"auth": {"key-management": "sae", "password": password}}
    return {
        **point,
        **({"hidden": "true"} if wifi.hidden else {}),
        **({"band": f"{wifi.band}GHz"} if wifi.band else {}),
    }


def _shown(ssid: str) -> str:
    """Return a network's name as `wpa_cli get_network N ssid` prints it, in base64."""
    plain = all(32 <= byte < 127 for byte in ssid.encode())
    return base64.b64encode(f'"{ssid}"'.encode() if plain else ssid.encode().hex().encode()).decode()
