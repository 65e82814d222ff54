"""Names: the daemon that publishes them, the addresses they resolve to, and conflicts between them."""

from collections.abc import Iterator

from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import PairRule, Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.ssh.shell import quote

START = "systemctl unmask avahi-daemon.service avahi-daemon.socket; systemctl enable --now avahi-daemon"
INSTALL = "apt-get install -y avahi-daemon libnss-mdns"


def runs_avahi(side: Side) -> bool:
    """Return whether the daemon that publishes .local names runs."""
    return side.active.get("avahi-daemon.service") == "active"


def check_avahi(where: Where, side: Side) -> Iterator[Finding]:
    """Check the daemon that publishes .local names."""
    if not runs_avahi(side):
        installed = not side.packages or "avahi-daemon" in side.packages
        yield Finding(
            "avahi-not-running",
            f"{side.name}: avahi-daemon does not run, so {side.name}.local does not resolve",
            commands=(FixCommand(where, START if installed else INSTALL, root=True, safe=True),),
        )


def check_names(pair: ComputerPair) -> Iterator[Finding]:
    """Check that each computer resolves the other's full name."""
    for where, side, other in pair.sides():
        if not runs_avahi(side) or not runs_avahi(other):
            continue  # already reported
        wrong = side.resolves - set(other.addresses)
        if not side.resolves:
            missing = bool(side.packages) and "libnss-mdns" not in side.packages
            yield Finding(
                "name-not-found",
                f"{side.name} does not find {other.name}.local, so it gets no data from that computer",
                "are both in one network, and does it let multicast through (port 5353)?",
                (FixCommand(where, INSTALL, root=True, safe=True),) if missing else (),
            )
        elif wrong and other.addresses:
            name = quote(f"{other.name}.local")
            yield Finding(
                "name-is-wrong",
                f"{side.name} takes {other.name}.local for {', '.join(sorted(wrong))}, "
                f"expected {', '.join(other.addresses)}",
                "remove that line from /etc/hosts; /etc/hosts.ur keeps the old file",
                (
                    FixCommand(
                        where,
                        f"cp -p /etc/hosts /etc/hosts.ur && grep -vwF -- {name} /etc/hosts.ur >/etc/hosts",
                        root=True,
                        safe=True,
                    ),
                ),
            )


def check_duplicates(pair: ComputerPair) -> Iterator[Finding]:
    """Check for two computers with one name: zeroconf then renames the second."""
    named = set()
    for _, side, _ in pair.sides():
        if side.announced and side.announced != side.name:
            named.add(side.name)
            yield duplicate(side.name, side.announced, ", ".join(side.addresses), side.user)
    for name, addresses in sorted(pair.twins.items()):
        if addresses and name not in named:
            yield duplicate(name, f"{name}-2", ", ".join(sorted(addresses)), pair.remote.user)


def duplicate(name: str, answers_to: str, address: str, user: str) -> Finding:
    """Return the finding that two computers are called NAME; the one that zeroconf renamed should be renamed."""
    login = quote(f"{user}@{answers_to}.local")
    return Finding(
        "duplicate-name",
        f"two computers are called {name}: the one at {address or 'another address'} answers to {answers_to}.local "
        f"only, and ROS there says {name}.local, which is the other one",
        "rename one of them; with its keys, if it is a robot:",
        (FixCommand("local", f"ur robot setup {login} --name {name}{answers_to.rpartition('-')[2]}"),),
    )


RULES: tuple[Rule, ...] = (
    SideRule(
        {"avahi-not-running": "avahi, which provides `.local` names, does not run on one of the two"}, check_avahi
    ),
    PairRule(
        {
            "name-not-found": "a name cannot be resolved",
            "name-is-wrong": "a name is resolved to the address of another computer, by `/etc/hosts`",
        },
        check_names,
    ),
    PairRule({"duplicate-name": "a third computer has the name of one of the two"}, check_duplicates),
)
