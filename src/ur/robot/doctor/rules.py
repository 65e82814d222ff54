"""What may be wrong between two computers: one function each, pure, given what was seen from both ends."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal
from urllib.parse import urlsplit

from ur.robot.doctor.observe import Side
from ur.robot.setup.there import PACKAGES
from ur.robot.ssh.shell import quote

WEAK_SIGNAL = -75.0  # dBm; below, rates fall and packets get lost
SLOW_RATE = 12.0  # Mbit/s; a compressed camera image at 30 Hz needs about that
CLOCK_SECONDS = 0.5  # tf's usual patience is about that
Where = Literal["here", "there"]


@dataclass(frozen=True, slots=True)
class Fix:
    """A script that cures a finding and can do no harm: on which computer, and whether as root."""

    where: Where
    script: str
    root: bool = False


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong: its kind (a stable id), what is the matter, what to do; `fix` where that is safe."""

    rule: str
    message: str
    help: str
    fix: Fix | None = None


@dataclass(frozen=True, slots=True)
class Advertised:
    """A node and the address that it told the master, with what each computer makes of the name in it."""

    node: str
    host: str
    here: frozenset[str]
    there: frozenset[str]


@dataclass(frozen=True, slots=True)
class Pair:
    """Both computers. `offset` (s): how far the robot's clock is ahead.

    `way_back` is what ssh said from there to here, '' when it logged in. `reaches_...` tell for each direction whether
    a connection to a free port arrives. `key_refused`: the robot wanted a password although we have a key.
    """

    here: Side
    there: Side
    offset: float
    way_back: str
    reaches_there: bool
    reaches_here: bool
    key_refused: bool = False
    advertised: tuple[Advertised, ...] = ()


def diagnose(pair: Pair) -> list[Finding]:
    """All findings, the most fundamental first; empty for a healthy pair."""
    return [finding for rule in RULES for finding in rule(pair)]


def check_avahi(pair: Pair) -> Iterator[Finding]:
    """The daemon that makes .local names."""
    for where, side in _sides(pair):
        if side.active.get("avahi-daemon.service") != "active":
            yield Finding(
                "avahi-not-running",
                f"{side.name}: avahi-daemon does not run, so nobody finds {side.name}.local",
                f"on {side.name}: sudo systemctl enable --now avahi-daemon",
                Fix(
                    where,
                    "systemctl unmask avahi-daemon.service avahi-daemon.socket; systemctl enable --now avahi-daemon",
                    True,
                ),
            )


def check_names(pair: Pair) -> Iterator[Finding]:
    """Each computer's full name, as the other understands it."""
    for where, side, other in (("here", pair.here, pair.there), ("there", pair.there, pair.here)):
        if side.active.get("avahi-daemon.service") != "active" or other.active.get("avahi-daemon.service") != "active":
            continue  # said already
        place: Where = "here" if where == "here" else "there"
        wrong = side.resolves - set(other.addresses)
        if not side.resolves:
            yield Finding(
                "name-not-found",
                f"{side.name} does not find {other.name}.local, so it gets no data from there",
                f"on {side.name}: sudo apt-get install libnss-mdns; are both in one network?",
            )
        elif wrong:
            name = quote(f"{other.name}.local")
            yield Finding(
                "name-is-wrong",
                f"{side.name} takes {other.name}.local for {', '.join(sorted(wrong))}, "
                f"expected {', '.join(other.addresses)}",
                f"take {other.name}.local out of /etc/hosts on {side.name}",
                Fix(
                    place,
                    f'n={name}; cp -p /etc/hosts /etc/hosts.ur && grep -vwF -- "$n" /etc/hosts.ur >/etc/hosts',
                    True,
                ),
            )


def check_duplicates(pair: Pair) -> Iterator[Finding]:
    """Two computers with one name: avahi gives the second another."""
    for _, side in _sides(pair):
        if side.announced and side.announced != side.name:
            yield Finding(
                "duplicate-name",
                f"{side.name} answers to {side.announced}.local only: another computer is called {side.name}.local",
                f"rename one of them: ur robot setup {side.announced}.local --name ANOTHER",
            )


def check_way_back(pair: Pair) -> Iterator[Finding]:
    """The login from the robot to here, which roslaunch on the robot needs; and the rights that sshd insists on."""
    for where, side in _sides(pair):
        loose = [path for path, mode in side.modes.items() if mode & (0o077 if path.endswith("id_ed25519") else 0o022)]
        if loose:
            paths = ", ".join("~" if path == "." else f"~/{path}" for path in loose)
            yield Finding(
                "loose-rights",
                f"{side.name}: others may write or read {paths}, so ssh refuses keys",
                f"on {side.name}: chmod go-w ~ ~/.ssh ~/.ssh/authorized_keys; chmod 600 ~/.ssh/id_*",
                Fix(where, "cd; chmod go-w . .ssh .ssh/authorized_keys; chmod 600 .ssh/id_ed25519; true"),
            )
            return
    if pair.key_refused:
        yield Finding(
            "key-refused",
            f"{pair.there.name} does not take the key of this computer",
            f"ur robot setup {pair.there.name}.local (it renews keys in both directions)",
        )
    if pair.way_back and pair.there.resolves:
        stale = "host key" in pair.way_back.lower() or "IDENTIFICATION" in pair.way_back
        yield Finding(
            "unknown-host-key-there" if stale else "no-login-there",
            f"{pair.there.name} cannot log in to {pair.here.name}: {pair.way_back}",
            f"ur robot setup {pair.there.name}.local (it renews keys in both directions)",
        )


def check_ports(pair: Pair) -> Iterator[Finding]:
    """ROS nodes listen on ports that the system chooses: all above 1024 must be open both ways."""
    for reached, target, where in (
        (pair.reaches_there, pair.there, "there"),
        (pair.reaches_here, pair.here, "here"),
    ):
        if not reached and (pair.here.resolves if where == "there" else pair.there.resolves):
            yield Finding(
                "closed-port",
                f"{target.name} lets no connection in at a free port, and ROS nodes use such ports",
                f"on {target.name}: allow the local network through its firewall (sudo ufw allow from NETWORK)",
            )


def check_environment(pair: Pair) -> Iterator[Finding]:
    """The robot's ROS variables: where the master is, and the name that its nodes tell."""
    side = pair.there
    full = f"{side.name}.local"
    rewrite = "ur robot setup writes ~/.ros_setup again; lines of your own in ~/.bashrc come after it"
    master = side.ros.get("ROS_MASTER_URI", "")
    if urlsplit(master).hostname not in (full, side.name, "localhost", *side.addresses):
        yield Finding(
            "wrong-master",
            f"{side.name}: ROS_MASTER_URI is {master or 'not set'}, expected http://{full}:11311",
            rewrite,
        )
    address = side.ros.get("ROS_IP", "")
    if address and not side.ros.get("ROS_HOSTNAME") and address not in side.addresses:
        yield Finding(
            "wrong-ros-ip",
            f"{side.name}: ROS_IP is {address}, which is not its address ({', '.join(side.addresses)})",
            f"take ROS_IP out of its shell files: {rewrite}",
        )
    name = side.ros.get("ROS_HOSTNAME", "")
    if name and name != full and name not in side.addresses:
        yield Finding(
            "wrong-ros-hostname",
            f"{side.name}: ROS_HOSTNAME is {name}, which others do not know; expected {full}",
            rewrite,
        )


def check_advertised(pair: Pair) -> Iterator[Finding]:
    """The names that running nodes told the master."""
    addresses = {*pair.here.addresses, *pair.there.addresses}
    for one in pair.advertised:
        for side, means in ((pair.here, one.here), (pair.there, one.there)):
            if not means & addresses:
                yield Finding(
                    "unresolvable-node",
                    f"node {one.node} says it is at {one.host}, and {side.name} "
                    + (f"takes that for {', '.join(sorted(means))}" if means else "does not know that name"),
                    "start it again from a shell with the right ROS_HOSTNAME ('ur env', ~/.ros_setup)",
                )


def check_clock(pair: Pair) -> Iterator[Finding]:
    """Clocks that disagree make tf refuse everything."""
    if abs(pair.offset) > CLOCK_SECONDS:
        by = f"{abs(pair.offset):.1f} s {'ahead of' if pair.offset > 0 else 'behind'}"
        yield Finding(
            "clock-offset",
            f"the clock of {pair.there.name} is {by} this one",
            f"on {pair.there.name}: sudo systemctl restart chrony; chronyc sources",
            Fix("there", "systemctl restart chrony && sleep 1 && chronyc -a 'burst 4/4' && chronyc -a makestep", True),
        )


def check_network(pair: Pair) -> Iterator[Finding]:
    """Loss, latency, and whether full frames get through."""
    for _, side in _sides(pair):
        other = pair.there.name if side is pair.here else pair.here.name
        if side.loss is not None and side.loss < 1 and side.full_frames is False:
            yield Finding(
                "mtu",
                f"full frames from {side.name} to {other} are lost, and large messages with them",
                "set the MTU of both network interfaces alike: ip link set DEVICE mtu 1500",
            )
        if side.loss and pair.here.resolves:
            yield Finding(
                "packet-loss",
                f"{side.loss:.0%} of packets from {side.name} to {other} are lost",
                "nearer to the access point; 5 GHz",
            )
        if side.latency and side.latency > 0.1:
            yield Finding(
                "latency",
                f"{side.latency * 1000:.0f} ms from {side.name} to {other} and back, expected below 100 ms",
                "switch WiFi power saving off (iw dev DEVICE set power_save off); 5 GHz",
            )


def check_wifi(pair: Pair) -> Iterator[Finding]:
    """Signal, rate and power saving of wireless links; nothing where there are none."""
    for where, side in _sides(pair):
        for wifi in side.wifi:
            if wifi.signal is not None and wifi.signal < WEAK_SIGNAL:
                yield Finding(
                    "weak-wifi",
                    f"{side.name}: the signal at {wifi.device} is {wifi.signal:.0f} dBm, "
                    f"expected above {WEAK_SIGNAL:.0f} dBm",
                    "nearer to the access point, or an antenna outside of metal",
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
                device = quote(wifi.device)
                yield Finding(
                    "wifi-power-save",
                    f"{side.name}: {wifi.device} saves power, so what is sent to it may wait 100 ms and more",
                    f"on {side.name}: sudo iw dev {device} set power_save off; for good: "
                    "sudo nmcli connection modify NAME 802-11-wireless.powersave 2",
                    Fix(where, f'PATH="$PATH:/usr/sbin:/sbin"; iw dev {device} set power_save off', True),
                )


def check_resources(pair: Pair) -> Iterator[Finding]:
    """Disk, memory, voltage."""
    for where, side in _sides(pair):
        if side.disk_free is not None and side.disk_free < 200:
            yield Finding(
                "full-disk",
                f"{side.name}: {side.disk_free:.0f} MB are left on its disk",
                f"on {side.name}: sudo apt-get clean; rosclean purge; journalctl --vacuum-size=50M",
                Fix(where, "apt-get clean; journalctl --quiet --vacuum-size=50M", True),
            )
        if side.memory_free is not None and side.memory_free < 100:
            yield Finding(
                "low-memory", f"{side.name}: {side.memory_free:.0f} MB of memory are left", "end programs there"
            )
        if side.throttled & 0x1:
            yield Finding("under-voltage", f"{side.name}: under-voltage now", "a stronger supply, a shorter cable")


def check_services(pair: Pair) -> Iterator[Finding]:
    """Units that failed, the boot services among them; and time synchronisation."""
    for unit in pair.there.failed:
        yield Finding(
            "failed-service",
            f"{pair.there.name}: {unit} failed",
            f"ur shell {pair.there.name} journalctl -u {unit}; then: sudo systemctl restart {unit}",
        )
    if pair.there.active.get("chrony.service") not in ("active", None) and "chrony.service" not in pair.there.failed:
        yield Finding(
            "no-time-synchronisation",
            f"{pair.there.name}: chrony does not run, so its clock drifts",
            f"on {pair.there.name}: sudo systemctl enable --now chrony",
            Fix("there", "systemctl enable --now chrony", True),
        )


def check_packages(pair: Pair) -> Iterator[Finding]:
    """What the robot lacks, and messages that the two define differently."""
    missing = [entry for entry in PACKAGES if not any(name in pair.there.packages for name in entry.split("|"))]
    if missing and pair.there.packages:
        names = " ".join(entry.split("|")[0] for entry in missing)
        yield Finding("missing-package", f"{pair.there.name} lacks {names}", f"ur robot setup {pair.there.name}.local")
    for name, version in sorted(pair.here.messages.items()):
        other = pair.there.messages.get(name, version)
        if other != version:
            yield Finding(
                "different-messages",
                f"{name} is {version} on {pair.here.name} and {other} on {pair.there.name}: topics may not connect",
                "bring both to one release: sudo apt-get update && sudo apt-get upgrade, on both",
            )


RULES: tuple[Callable[[Pair], Iterator[Finding]], ...] = (
    check_avahi,
    check_names,
    check_duplicates,
    check_way_back,
    check_ports,
    check_environment,
    check_advertised,
    check_clock,
    check_network,
    check_wifi,
    check_resources,
    check_services,
    check_packages,
)


def _sides(pair: Pair) -> tuple[tuple[Where, Side], tuple[Where, Side]]:
    return ("here", pair.here), ("there", pair.there)
