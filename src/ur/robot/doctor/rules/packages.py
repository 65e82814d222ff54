"""Installed packages: those missing on one of the two computers, and messages that they define differently."""

from collections.abc import Iterator

from ur.robot.doctor.findings import ComputerPair, Finding, FixCommand, Where
from ur.robot.doctor.rules.registry import PairRule, Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.setup import robot_states as remote
from ur.robot.setup import viewer_states as local
from ur.robot.ssh.shell import quote
from ur.system.releases import describe_lack, find_release, load_ros_packages

SHOWN = 4
HERE = "use a computer with Debian 12 or later, or Ubuntu 22.04 or later"
BUILD = "cd ~/catkin_ws && catkin_make"


def check_release(where: Where, side: Side) -> Iterator[Finding]:
    """Check for a system without ROS 1 packages.

    Users' computers may use this project's Debian root, robots may not.
    """
    if side.release is None or (where == "local" and find_release(side.release).ros == "brought"):
        return
    if reason := describe_lack(side.release):
        help = "flash Debian 12 or 13, or Raspberry Pi OS 12 or 13 (64 bits)"
        yield Finding("unsupported-release", f"{side.name}: {reason}", help if where == "remote" else HERE)


def check_missing(where: Where, side: Side) -> Iterator[Finding]:
    """Check for packages that `ur setup` or `ur robot setup` installs."""
    wanted = remote.PACKAGES if where == "remote" else local.PACKAGES
    if side.release and find_release(side.release).ros != "native":
        wanted = tuple(sorted({*wanted} - {*load_ros_packages()}))
    missing = [entry.split("|") for entry in wanted if not any(name in side.packages for name in entry.split("|"))]
    if missing and side.packages:
        names = " ".join(entry[0] for entry in missing)
        yield Finding("missing-package", f"{side.name} lacks {names}", commands=(_install(where, missing),))


def _install(where: Where, missing: list[list[str]]) -> FixCommand:
    install = "DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends"
    plain = [entry[0] for entry in missing if len(entry) == 1]
    lines = ["apt-get update"] + ([f"{install} {quote(*plain)}"] if plain else [])
    lines += [
        "{ " + " || ".join(f"{install} {quote(name)}" for name in entry) + "; }" for entry in missing if len(entry) > 1
    ]
    return FixCommand(where, " && ".join(lines), root=True, safe=True)


def check_messages(pair: ComputerPair) -> Iterator[Finding]:
    """Check for messages that both computers have, but with different definitions."""
    differing: dict[str, list[str]] = {}
    for name, message in pair.local.messages.items():
        other = pair.remote.messages.get(name)
        if other and other.digest != message.digest:
            differing.setdefault(name.partition("/")[0], []).append(name)
    for package, found in sorted(differing.items()):
        types = sorted({name.partition("/")[2].partition(".")[0] for name in found})
        shown = ", ".join(types[:SHOWN]) + (" ..." if len(types) > SHOWN else "")
        # Of a definition and the modules built from it, the definition can be copied.
        name = max(found, key=lambda each: "." in each)
        places = [f"{side.name}: {_version(side, package, side.messages[name].folder)}" for _, side, _ in pair.sides()]
        yield Finding(
            "different-messages",
            f"{package} is not the same on both ({shown}; {', '.join(places)}): topics of these types do not connect",
            *_align(pair, package, name),
        )


def _version(side: Side, package: str, folder: str) -> str:
    names = _debian(side, package)
    return f"{names[0]} {side.packages[names[0]]}" if names and not folder.startswith("~") else folder


def _debian(side: Side, package: str) -> list[str]:
    """Return the installed Debian packages of a ROS package."""
    name = package.replace("_", "-")
    return [each for each in (f"python3-{name}", f"lib{name}-dev", f"ros-{name}") if each in side.packages]


def _align(pair: ComputerPair, package: str, name: str) -> tuple[str, tuple[FixCommand, ...]]:
    folders = [side.messages[name].folder for _, side, _ in pair.sides()]
    if not any(folder.startswith("~") for folder in folders):
        return "bring both to one release:", tuple(
            FixCommand(where, f"apt-get update && apt-get install -y --only-upgrade {quote(*names)}", root=True)
            for where, side, _ in pair.sides()
            if (names := _debian(side, package))
        )
    if "." not in name:
        help = "the definitions are the same, and one was built before the last change: build both"
        return help, tuple(FixCommand(where, BUILD) for where, side, _ in pair.sides() if side.built)
    mine = folders[0].startswith("~")
    folder = folders[0] if mine else folders[1]
    left, right = _path(folder), f"{quote(pair.login)}:{_path(folder).removeprefix('~/')}"
    if mine:
        copy, help = (
            f"rsync -a {left}/ {right}/",
            f"if the one of {pair.local.name} is right, copy it (and build again):",
        )
    else:
        copy, help = f"rsync -a {right}/ {left}/", f"copy the one of {pair.remote.name}, which lies in its workspace:"
    where, target, _ = pair.sides()[1 if mine else 0]
    return help, (FixCommand("local", copy), *([FixCommand(where, BUILD)] if target.built else []))


def _path(folder: str) -> str:
    return f"~/{quote(folder[2:])}" if folder.startswith("~/") else quote(folder)


RULES: tuple[Rule, ...] = (
    SideRule({"unsupported-release": "the system does not package ROS 1"}, check_release, simulation=True, ros1=True),
    SideRule({"missing-package": "something that one of the two needs is not installed"}, check_missing, ros1=True),
    PairRule(
        {"different-messages": "both know a message, but not as the same: topics do not connect"},
        check_messages,
        ros1=True,
    ),
)
