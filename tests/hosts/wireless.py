"""A laptop, and a robot `bob` with nothing but WiFi, under either manager; only the radio is pretended.

No kernel that the benches run on has mac80211_hwsim (there is no /lib/modules, and containers load none): radio.py and
nm_radio.py stand in for wpa_supplicant, hostapd and NetworkManager's radio. Addresses, DHCP in both directions, mDNS
and ssh are real.
"""

import json
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from tests.hosts.bench import Bench, Machine, wait_until
from tests.hosts.bench.nm_radio import LINKS
from tests.hosts.managed import SNAPSHOT, TAKE_OVER, has_other_leader
from tests.hosts.test_netplan import (
    AIR,
    CLOUD,
    ETHER,
    FILES,
    HOME_PASSWORD,
    SERVER,
    login_pair,
    make_wireless,
)

MANAGERS = ("netplan", "NetworkManager")
NM_SETTINGS = """\
[main]
no-auto-default=*
[keyfile]
unmanaged-devices=interface-name:host0;interface-name:air;interface-name:ether
[device]
match-device=interface-name:wlan0
managed=1
"""
LINK = """\
[connection]
id=bench-{name}
uuid={uuid}
type=ethernet
interface-name=wlan0
autoconnect=false
[ipv4]
method={method}
[ipv6]
method=link-local
"""
HOME = f"""\
[connection]
id=Home
uuid=33333333-07ad-4d0f-a8f1-6ad8cd0e3c11
type=wifi
[wifi]
mode=infrastructure
ssid=Home
[wifi-security]
key-mgmt=wpa-psk
psk={HOME_PASSWORD}
[ipv4]
method=auto
"""
# The bridge of the radio's other end is in the robot: masquerading of the hotspot would drop multicasts there.
RADIO_SERVICE = """\
[Unit]
After=NetworkManager.service
[Service]
ExecStartPre=-/bin/sh -c 'echo 0 >/proc/sys/net/bridge/bridge-nf-call-iptables'
ExecStart=/usr/local/bin/nmcli serve
Restart=always
[Install]
WantedBy=multi-user.target
"""


@dataclass(frozen=True)
class Wireless:
    """The pair, and what differs by the manager of the robot's networks."""

    bench: Bench
    manager: str

    @property
    def laptop(self) -> Machine:
        return self.bench["laptop"]

    @property
    def robot(self) -> Machine:
        return self.bench["robot"]

    def wait_served(self) -> None:
        manager = ("NetworkManager", "nm-radio") if self.manager == "NetworkManager" else ("systemd-networkd",)
        units = ("ssh", "avahi-daemon", *manager)
        self.robot.wait_for(" && ".join(f"systemctl is-active --quiet {unit}" for unit in units), deadline=120)

    def wait_rebooted(self, leader: int) -> None:
        wait_until(lambda: has_other_leader(self.robot, leader), "the robot starts again", 120)
        self.wait_served()

    def set_air(self, *ssids: str) -> None:
        """Set which networks are in reach."""
        self.robot.write("/etc/bench-air.new", json.dumps({ssid: AIR[ssid] for ssid in ssids}))
        self.robot.run("mv /etc/bench-air.new /etc/bench-air.json").check()  # never half of it

    def wait_uses(self, ssid: str) -> None:
        """Wait until the robot has joined a network."""
        said = "wpa_cli -i wlan0 status | grep -qx ssid="
        if self.manager == "NetworkManager":
            said = "nmcli -g 802-11-wireless.ssid connection show "
            said += '"$(nmcli -t -f DEVICE,CON-UUID device status | sed -n s/^wlan0://p)" | grep -qx '
        self.robot.wait_for(f"{said}{ssid} && ip -4 address show wlan0 | grep -q 'inet 10.77.0'", deadline=120)

    def look(self) -> list[str]:
        """All that must be as before a change that fails."""
        files = FILES if self.manager == "netplan" else SNAPSHOT
        return [
            self.robot.run(files).out,
            self.robot.run("cat /proc/sys/kernel/hostname").check().out,
            self.laptop.run("cat .ssh/known_hosts .config/ubiquity_launches/robots/*", user="pat").out,
        ]


@contextmanager
def wireless_pair(manager: str) -> Iterator[Wireless]:
    with login_pair() as bench:
        laptop, robot = bench["laptop"], bench["robot"]
        pair = Wireless(bench, manager)
        if manager == "netplan":
            robot.write("/etc/netplan/50-cloud-init.yaml", CLOUD, mode=0o600)
            robot.run("rm /etc/systemd/network/10-host0.network && netplan apply").check()
            make_wireless(bench)
        else:
            laptop.run(SERVER).check()
            pair.set_air(*AIR)
            shutil.copy(Path(__file__).parent / "bench/nm_radio.py", robot.root / "usr/local/bin/nmcli")
            (robot.root / "usr/local/bin/nmcli").chmod(0o755)
            robot.write("/etc/systemd/system/nm-radio.service", RADIO_SERVICE)
            robot.write("/etc/systemd/system/ether.service", ETHER.replace("systemd-networkd", "NetworkManager"))
            robot.write("/etc/NetworkManager/conf.d/bench.conf", NM_SETTINGS)
            folder = "/etc/NetworkManager/system-connections"
            robot.write(f"{folder}/Home.nmconnection", HOME, mode=0o600)
            for mode, uuid in LINKS.items():
                method = "shared\naddress1=10.83.46.1/24" if mode == "ap" else "auto"
                text = LINK.format(name=mode, uuid=uuid, method=method)
                robot.write(f"{folder}/bench-{mode}.nmconnection", text, mode=0o600)
            robot.run("rm /etc/systemd/network/10-host0.network").check()
            robot.run(f"{TAKE_OVER.rpartition(' && ')[0]}; systemctl enable nm-radio ether").check()
            leader = robot.leader
            robot.run("systemctl reboot --no-block")
            pair.wait_rebooted(leader)
        pair.wait_uses("Home")
        yield pair


__all__ = ["MANAGERS", "Wireless", "wireless_pair"]
