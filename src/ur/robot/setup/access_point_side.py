"""Program of a robot: opens its own access point where none of its networks is in reach, and closes it again.

It is copied to the robot as one file. Arguments, in s: how long it looks for a network before it opens (SEEK), and how
often it then looks for one again (LOOK). `close` closes what an ended process has left open.

A robot has a network, and keeps it, while its wireless device has a carrier and an address, of any service, or any
device has a default route: a cable that leads no further, as to a lidar, does not count. No user is thrown off the
access point: the robot looks again only after LOOK s in which no TCP connection to a neighbour that answers was open,
and fewer packets arrived than a program sends. To look, it closes the access point for JOIN s, since few devices
receive other networks while they serve one. While a change of `ur robot` is pending, it does nothing.
"""

import os
import shutil
import socket
import subprocess
import sys
import time
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

SEEK, LOOK, JOIN, STEP = 180.0, 120.0, 30.0, 5.0
PACKETS = 5.0  # received each second: a telephone that only stays joined sends fewer, a page or ROS 2 more
ADDRESS = "10.83.46.1"
PASSWORD = Path("/etc/ubiquity/access-point")
RUN = Path("/run/ur-access-point")
PENDING = Path("/var/lib/ubiquity/change/pending")
UUID = "5c1ee5a1-64fb-4c73-8f9c-7a0a1c0d0f2e"
PROFILE = Path("/run/NetworkManager/system-connections/ur-access-point.nmconnection")
# Some devices, as a Raspberry Pi's, refuse clients unless protected management frames (pmf) are switched off.
KEYFILE = (
    f"[connection]\nid=ur-access-point\nuuid={UUID}\ntype=wifi\nautoconnect=false\ninterface-name={{device}}\n"
    "[wifi]\nmode=ap\nband=bg\nchannel=6\nssid={bytes}\n"
    "[wifi-security]\nkey-mgmt=wpa-psk\nproto=rsn\npairwise=ccmp\ngroup=ccmp\npmf=1\npsk={password}\n"
    f"[ipv4]\nmethod=shared\naddress1={ADDRESS}/24\n[ipv6]\nmethod=link-local\n"
)
# By its name, networkd prefers it to the file that netplan makes.
NETWORK = Path("/run/systemd/network/05-ur-access-point.network")
SERVED = (
    f"[Match]\nName={{device}}\n[Network]\nAddress={ADDRESS}/24\nLinkLocalAddressing=ipv6\n"
    "ConfigureWithoutCarrier=yes\nDHCPServer=yes\n[DHCPServer]\nEmitDNS=no\nEmitRouter=no\n"
)
HOSTAPD = (
    "interface={device}\nssid={ssid}\nhw_mode=g\nchannel=6\nieee80211n=1\nwmm_enabled=1\n"
    "wpa=2\nwpa_key_mgmt=WPA-PSK\nrsn_pairwise=CCMP\nwpa_passphrase={password}\n"
)


@dataclass
class Policy:
    """Decides when to open and close; times in s. `looked` is when it was opened or last in use, None while closed."""

    patience: float
    seek: float = SEEK
    look: float = LOOK
    looked: float | None = None
    _lost: float | None = field(default=None, init=False)

    def decide(self, now: float, *, online: bool, used: bool) -> str:
        """Return open, close or ''. `online` counts while it is closed, `used` while it is open."""
        if self.looked is not None:
            self.looked = now if used else self.looked
            return "close" if now - self.looked >= self.look else ""
        if online:
            self._lost, self.patience = None, self.seek
            return ""
        self._lost = now if self._lost is None else self._lost
        if now - self._lost < self.patience:
            return ""
        self.looked = now
        return "open"

    def close(self, now: float, patience: float = JOIN) -> None:
        """Note that it is closed; it may open again after `patience`."""
        self.looked, self._lost, self.patience = None, now, patience


def call(line: str) -> list[str] | None:
    """Run a program with these arguments; return the lines of its output, or None if it fails."""
    with suppress(OSError, subprocess.TimeoutExpired):
        done = subprocess.run(line.split(), capture_output=True, text=True, errors="replace", timeout=40, check=False)
        return done.stdout.splitlines() if done.returncode == 0 else None
    return None


class NetworkManager:
    """A device that NetworkManager manages: its hotspot, with its DHCP server."""

    found = "seen"  # the file of the networks in reach, as `ur robot wifi` reads them
    scan = "nmcli -t -f IN-USE,SIGNAL,FREQ,SECURITY,SSID device wifi list --rescan yes"

    def __init__(self, device: str) -> None:
        self.device = device

    def open(self, values: dict[str, str]) -> bool:
        """Open the access point; return whether that worked."""
        PROFILE.write_text(KEYFILE.format(**values))
        call(f"nmcli connection load {PROFILE}")
        return call(f"nmcli --wait 30 connection up uuid {UUID} ifname {self.device}") is not None

    def is_open(self) -> bool:
        """Return whether it is still open."""
        return f"{self.device}:{UUID}" in (call("nmcli -t -f DEVICE,CON-UUID device status") or ())

    def close(self) -> None:
        """Close it, and have the device join a network."""
        call(f"nmcli connection delete uuid {UUID}")
        PROFILE.unlink(missing_ok=True)


class Networkd:
    """A device that netplan and systemd-networkd manage: hostapd, with networkd's DHCP server."""

    found = "air"

    def __init__(self, device: str) -> None:
        self.device, self.scan = device, f"wpa_cli -i {device} scan_results"
        self._hostapd: subprocess.Popen[bytes] | None = None

    def open(self, values: dict[str, str]) -> bool:
        """Open the access point; return whether that worked."""
        call(f"systemctl stop netplan-wpa-{self.device}.service")
        NETWORK.parent.mkdir(parents=True, exist_ok=True)
        NETWORK.write_text(SERVED.format(**values))
        NETWORK.chmod(0o644)
        (RUN / "hostapd.conf").write_text(HOSTAPD.format(**values))
        self._hostapd = subprocess.Popen(["hostapd", str(RUN / "hostapd.conf")])
        call("networkctl reload")
        time.sleep(2)
        return self.is_open()

    def is_open(self) -> bool:
        """Return whether it is still open."""
        return self._hostapd is not None and self._hostapd.poll() is None

    def close(self) -> None:
        """Close it, and have the device join a network."""
        if self._hostapd is not None:
            self._hostapd.terminate()
            self._hostapd.wait()
        NETWORK.unlink(missing_ok=True)
        call("networkctl reload")
        call(f"systemctl start netplan-wpa-{self.device}.service")
        call(f"networkctl reconfigure {self.device}")


def find_radio() -> NetworkManager | Networkd | None:
    """Find a wireless device that may serve, by who manages it."""
    for line in call("nmcli -t -f DEVICE,TYPE,STATE device status") or ():
        device, kind, state = [*line.split(":", 2), "", ""][:3]
        if kind == "wifi" and not state.startswith("unmanaged"):
            return None if state.startswith("unavailable") else NetworkManager(device)
    if not shutil.which("netplan") or not shutil.which("hostapd"):
        return None
    links = (line.split() for line in call("networkctl --no-legend --no-pager list") or ())
    return next((Networkd(each[1]) for each in links if len(each) == 5 and each[2] == "wlan"), None)


def is_online(device: str) -> bool:
    """Return whether the robot has a network, as far as it knows."""
    routes = [*(call("ip -4 route show default") or ()), *(call("ip -6 route show default") or ())]
    carrier = "LOWER_UP" in str(call(f"ip link show dev {device}"))
    addressed = carrier and bool(call(f"ip -o address show dev {device} scope global"))
    return addressed or any("linkdown" not in route for route in routes)


@dataclass
class Usage:
    """Determines whether the open access point is used."""

    device: str
    _packets: int = 0
    _asked: float = 0.0

    def is_used(self, now: float) -> bool:
        """Return whether it was used since the last call; `now` in s."""
        packets = int(Path(f"/sys/class/net/{self.device}/statistics/rx_packets").read_text())
        busy = packets - self._packets > PACKETS * max(now - self._asked, 1.0)
        self._packets, self._asked = packets, now
        rows = call(f"ss -Htn state established src {ADDRESS}") or ()
        peers = {row.split()[-1].rpartition(":")[0] for row in rows}
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            for peer in peers:  # the entry of a neighbour that has gone then fails before the next call
                with suppress(OSError):
                    sender.sendto(b"", (peer, 9))
        entries = [entry for peer in peers for entry in call(f"ip neigh show {peer} dev {self.device}") or ()]
        return busy or any("FAILED" not in each and "INCOMPLETE" not in each for each in entries)


def open_point(radio: NetworkManager | Networkd) -> Usage | None:
    """Open the access point; return what observes its use, or None if that failed."""
    RUN.mkdir(mode=0o700, exist_ok=True)
    (RUN / radio.found).write_text("\n".join(call(radio.scan) or ()))
    (RUN / "open").write_text(f"{type(radio).__name__} {radio.device}")
    name = os.uname().nodename.partition(".")[0]
    values = {"ssid": name, "bytes": "".join(f"{byte};" for byte in name.encode()), "device": radio.device}
    if radio.open({**values, "password": PASSWORD.read_text().strip()}):
        sys.stdout.write(f"no network in reach: {radio.device} opens the network {name}, this robot is {ADDRESS}\n")
        return Usage(radio.device)
    sys.stdout.write(f"{radio.device} cannot open an access point\n")
    close_point(radio)
    return None


def close_point(radio: NetworkManager | Networkd | None = None) -> bool:
    """Close the access point, or what an earlier process has left; return whether there was one."""
    if not (RUN / "open").exists():
        return False
    kind, device = (RUN / "open").read_text().split()
    (radio or (NetworkManager if kind == "NetworkManager" else Networkd)(device)).close()
    for name in ("seen", "air", "hostapd.conf", "open"):
        (RUN / name).unlink(missing_ok=True)
    return True


def main(seek: float = SEEK, look: float = LOOK) -> None:
    """Open and close the access point until this process is ended."""
    again = close_point() or (RUN / "again").exists()
    (RUN / "again").unlink(missing_ok=True)
    policy, radio, usage = Policy(min(JOIN, seek) if again else seek, seek, look), find_radio(), None
    while True:
        time.sleep(STEP)
        now, ended = time.monotonic(), bool(usage and radio and not radio.is_open())
        radio = radio or find_radio()
        if radio is None or (PENDING.exists() and not ended):
            continue
        online = usage is None and is_online(radio.device)
        action = policy.decide(now, online=online, used=usage is not None and usage.is_used(now))
        if action == "open":
            radio = find_radio()
            usage = open_point(radio) if radio else None
            if usage is None:
                policy.close(time.monotonic(), look)
        elif ended or action == "close":
            sys.stdout.write("another program has ended it\n" if ended else "no client uses it: looking for networks\n")
            close_point(radio)
            policy.close(time.monotonic())
            radio = usage = None


if __name__ == "__main__":
    os.umask(0o077)
    if sys.argv[1:] != ["close"]:
        main(*map(float, sys.argv[1:3]))
    elif close_point():
        (RUN / "again").touch()
