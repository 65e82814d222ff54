"""What the computer in front of the user, the viewer, shall be."""

from __future__ import annotations

from pathlib import Path

from ur.robot.setup.environment import viewer_environment
from ur.robot.setup.facts import Facts, Request
from ur.robot.setup.keys import HOST_KEY, KEY, KNOWN_HOSTS, WantedKeyPair, WantedOwnLogin
from ur.robot.setup.packages import WantedPackages, WantedService
from ur.robot.setup.wanted import Wanted, WantedFile, WantedFolder, WantedGroups, WantedLine

PACKAGES = (
    *("openssh-client", "openssh-server", "avahi-daemon", "libnss-mdns", "chrony"),
    *("sshfs", "rsync", "xauth", "x11-apps"),
)
GROUPS = ("dialout", "video", "plugdev", "input")
TIME_SERVER = """\
# Robots without internet take the time from here. Written by ur setup.
local stratum 10
allow 10.0.0.0/8
allow 172.16.0.0/12
allow 192.168.0.0/16
allow 169.254.0.0/16
allow fe80::/10
"""


def base_request(user: str) -> Request:
    """The facts that `wanted_here` needs."""
    return Request(user, files=frozenset({HOST_KEY}))


def wanted_here(facts: Facts, repository: Path, *, system: bool = True) -> list[Wanted]:
    """The viewer's wanted states, in the order of their making. Without `system`, only those that need no root."""
    items: list[Wanted] = []
    if system:
        items += [
            WantedPackages("packages", PACKAGES),
            WantedService("ssh server", "ssh.service"),
            WantedService("names ending in .local", "avahi-daemon.service"),
            WantedFile(
                "time for robots", "/etc/chrony/conf.d/ubiquity.conf", TIME_SERVER, then="systemctl try-restart chrony"
            ),
            WantedService("time", "chrony.service"),
            WantedGroups("groups", GROUPS),
        ]
    items += [*viewer_environment(repository), *own_keys(facts)]
    return items


def own_keys(facts: Facts) -> list[Wanted]:
    """A user's key pair, and the way from a computer to itself by its full name, which roslaunch takes."""
    items: list[Wanted] = [
        WantedFolder("ssh folder", "~/.ssh", mode=0o700),
        WantedKeyPair("ssh key", KEY, f"{facts.user}@{facts.hostname}"),
        WantedOwnLogin("login to itself"),
    ]
    host_key = facts.file(HOST_KEY).text
    if host_key:
        items.append(known_host("its own host key", (facts.hostname,), host_key))
    return items


def known_host(title: str, names: tuple[str, ...], host_key: str, addresses: tuple[str, ...] = ()) -> WantedLine:
    """A computer's public host key in ~/.ssh/known_hosts, under NAME.local, NAME and addresses."""
    hosts = ",".join([*(f"{name}.local" for name in names), *names, *addresses])
    kind, key = host_key.split()[:2]
    old = tuple(f"{name}.local," for name in names)
    return WantedLine(title, KNOWN_HOSTS, f"{hosts} {kind} {key}", mode=0o600, old=old)
