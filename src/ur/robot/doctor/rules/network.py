"""The network between the two: ports, full frames, packet loss, latency, and wireless links."""

from collections.abc import Iterator

from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import PairRule, Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ssh.shell import quote

WEAK_SIGNAL = -75.0  # dBm; below, rates fall and packets get lost
SLOW_RATE = 12.0  # Mbit/s; a compressed camera image at 30 Hz needs about that


def check_wifi(where: Where, side: Side) -> Iterator[Finding]:
    """Check each wireless link that is up."""
    for wifi in side.wifi:
        if wifi.signal is not None and wifi.signal < WEAK_SIGNAL:
            yield Finding(
                "weak-wifi",
                f"{side.name}: the signal at {wifi.device} is {wifi.signal:.0f} dBm, "
                f"expected above {WEAK_SIGNAL:.0f} dBm",
                "nearer to the access point, or an antenna outside metal; measure with 'ur doctor ROBOT --wireless'",
            )
        elif wifi.rate is not None and wifi.rate < SLOW_RATE:
            band = f" in the {wifi.band} band" if wifi.band else ""
            yield Finding(
                "slow-wifi",
                f"{side.name}: {wifi.device} sends with {wifi.rate:g} Mbit/s{band} although the signal is good, "
                f"expected {SLOW_RATE:g} Mbit/s or more",
                "another channel; "
                + ("5 GHz: a dual band (802.11ac) adapter" if wifi.band == "2.4 GHz" else "fewer computers on it"),
            )
        if wifi.power_save:
            yield Finding(
                "wifi-power-save",
                f"{side.name}: {wifi.device} saves power, so what is sent to it may wait 100 ms and more",
                "for good: sudo nmcli connection modify NAME 802-11-wireless.powersave 2",
                (FixCommand(where, f"iw dev {quote(wifi.device)} set power_save off", root=True, safe=True),),
            )


LATENCY_SECONDS = 0.1
# Insert into every chain that may drop incoming packets, since each of them must accept them.
_NFT = (
    'nft list chains | awk -v a={address} \'$1=="table"{{t=$2" "$3}} $1=="chain"{{c=$2}} '
    '/hook input/&&t~/^(ip|inet) /{{print "insert rule",t,c,"ip saddr",a,"accept"}}\' | nft -f -'
)
_FIREWALLS = {
    "ufw": "ufw allow from {address}",
    "firewalld": "firewall-cmd --zone=trusted --add-source={address} && firewall-cmd --runtime-to-permanent",
    "nft": _NFT,
    "iptables": "iptables -I INPUT -s {address} -j ACCEPT",
}


def check_address(where: Where, side: Side) -> Iterator[Finding]:  # noqa: ARG001 - of the protocol
    """Check that the computer is connected to a network."""
    if side.name and not side.addresses:
        yield Finding(
            "no-network", f"{side.name} has no address in any network", "connect it; what there is: nmcli device status"
        )


def check_ports(pair: ComputerPair) -> Iterator[Finding]:
    """Check that the firewalls let ROS nodes connect: nodes listen on ports above 1024, chosen by the system."""
    ways: tuple[tuple[bool, Where, Side, Side], ...] = (
        (pair.reaches_remote, "remote", pair.remote, pair.local),
        (pair.reaches_local, "local", pair.local, pair.remote),
    )
    for reached, where, target, other in ways:
        if not reached and other.resolves:
            yield Finding(
                "closed-port",
                f"{target.name} lets no connection in from {other.name} at a free port, and ROS nodes use such ports",
                "let the other computer through the firewall"
                + (
                    "; until the next boot, then its own file counts:"
                    if target.firewall in ("nft", "iptables")
                    else ":"
                ),
                _open(where, target.firewall, other),
            )


def _open(where: Where, firewall: str, other: Side) -> tuple[FixCommand, ...]:
    line = _FIREWALLS.get(firewall)
    if not line or not other.addresses:
        return ()
    return tuple(FixCommand(where, line.format(address=quote(address)), root=True) for address in other.addresses)


def check_network(pair: ComputerPair) -> Iterator[Finding]:
    """Check packet loss, latency, and whether full frames arrive."""
    frames = [side for _, side, _ in pair.sides() if side.full_frames is False and (side.loss is None or side.loss < 1)]
    if frames:
        yield _lost_frames(pair, frames[0])
    for _, side, other in pair.sides():
        if side.loss and side.resolves:
            yield Finding(
                "packet-loss",
                f"{side.loss:.0%} of packets from {side.name} to {other.name} are lost",
                f"nearer to the access point; 5 GHz; while you walk: ur doctor {other.name} --wireless --watch",
            )
        if side.latency and side.latency > LATENCY_SECONDS:
            yield Finding(
                "latency",
                f"{side.latency * 1000:.0f} ms from {side.name} to {other.name} and back, "
                f"expected below {LATENCY_SECONDS * 1000:.0f} ms",
                "switch power saving of the WiFi off (iw dev DEVICE set power_save off); 5 GHz",
            )


_WSL = "cat /proc/sys/kernel/osrelease; wslinfo --networking-mode 2>/dev/null"


def check_wsl(where: Where, side: Side) -> Iterator[Finding]:
    """Check whether Windows hides the computer from the robot: WSL 2 with its default network."""
    release, _, mode = side.observed.get("wsl", "").lower().partition("\n")
    if where == "local" and "microsoft" in release and mode.strip() not in ("mirrored", "bridged"):
        yield Finding(
            "wsl-network",
            f"{side.name} is WSL in Windows, behind an address translation: names ending in .local are not found, and "
            "the robot does not reach it; USB devices such as a joystick are not there either",
            "in Windows 11, write '[wsl2]' and 'networkingMode=mirrored' as lines of %UserProfile%\\.wslconfig, then "
            "run 'wsl --shutdown'; or drive from a browser of Windows: docs/how-to/laptops.md",
        )


def _lost_frames(pair: ComputerPair, side: Side) -> Finding:
    other = pair.remote if side is pair.local else pair.local
    message = f"full frames from {side.name} to {other.name} are lost, and large messages with them"
    if not (side.mtu and other.mtu and side.mtu != other.mtu):
        return Finding("mtu", message, "something between the two takes only smaller ones: set a lower MTU on both")
    # Both in one network: the one with the smaller frames is the one to change.
    where, odd = min(((where, side) for where, side, _ in pair.sides()), key=lambda each: each[1].mtu or 0)
    mtu = max(side.mtu, other.mtu)
    return Finding(
        "mtu",
        f"{message}: the MTU of {odd.device} on {odd.name} is {odd.mtu}, the other one's is {mtu}",
        commands=(FixCommand(where, f"ip link set {quote(odd.device)} mtu {mtu}", root=True, safe=True),),
    )


RULES: tuple[Rule, ...] = (
    SideRule({"no-network": "a computer is in no network"}, check_address),
    SideRule({"wsl-network": "Windows hides its WSL from the robot"}, check_wsl, observe={"wsl": _WSL}),
    PairRule(
        {"closed-port": "a firewall keeps connections out; ROS nodes use any port above 1024"}, check_ports, ros1=True
    ),
    PairRule(
        {
            "mtu": "large messages are lost, small ones are not",
            "packet-loss": "packets are lost on the way",
            "latency": "packets take too long",
        },
        check_network,
    ),
    SideRule(
        {
            "weak-wifi": "the signal is too weak",
            "slow-wifi": "the link is slow although the signal is good",
            "wifi-power-save": "packets wait until the adapter wakes up",
        },
        check_wifi,
    ),
)
