"""What is installed: packages that one of the two lacks, and messages that they define differently."""

from __future__ import annotations

from collections.abc import Iterator

from ur.robot.doctor.model import Command, Finding, Pair, Where
from ur.robot.doctor.rules.registry import PairRule, Rule, SideRule
from ur.robot.doctor.side import Side
from ur.robot.setup import here, there
from ur.robot.ssh.shell import quote

SHOWN = 4


def check_missing(where: Where, side: Side) -> Iterator[Finding]:
    """What `ur setup` or `ur robot setup` installs."""
    wanted = there.PACKAGES if where == "there" else here.PACKAGES
    missing = [entry.split("|") for entry in wanted if not any(name in side.packages for name in entry.split("|"))]
    if missing and side.packages:
        names = " ".join(entry[0] for entry in missing)
        yield Finding("missing-package", f"{side.name} lacks {names}", commands=(_install(where, missing),))


def _install(where: Where, missing: list[list[str]]) -> Command:
    install = "DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends"
    plain = [entry[0] for entry in missing if len(entry) == 1]
    lines = ["apt-get update"] + ([f"{install} {quote(*plain)}"] if plain else [])
    lines += [
        "{ " + " || ".join(f"{install} {quote(name)}" for name in entry) + "; }" for entry in missing if len(entry) > 1
    ]
    return Command(where, " && ".join(lines), root=True, safe=True)


def check_messages(pair: Pair) -> Iterator[Finding]:
    """Messages that both know, and not as the same."""
    differing: dict[str, list[str]] = {}
    for name, message in sorted(pair.here.messages.items()):
        other = pair.there.messages.get(name)
        if other and other.digest != message.digest:
            package, _, file = name.partition("/")
            differing.setdefault(package, []).append(file)
    for package, files in differing.items():
        shown = ", ".join(files[:SHOWN]) + (" ..." if len(files) > SHOWN else "")
        folders = [side.messages[f"{package}/{files[0]}"].folder for side in (pair.here, pair.there)]
        places = [
            f"{side.name}: {_version(side, package, folder)}"
            for side, folder in zip((pair.here, pair.there), folders, strict=True)
        ]
        yield Finding(
            "different-messages",
            f"{package} is not the same on both ({shown}; {', '.join(places)}): topics of these types do not connect",
            *_align(pair, package, folders[0], folders[1]),
        )


def _version(side: Side, package: str, folder: str) -> str:
    debian = _debian(package)
    return f"{debian} {side.packages[debian]}" if not folder.startswith("~") and debian in side.packages else folder


def _debian(package: str) -> str:
    return f"ros-{package.replace('_', '-')}"


def _align(pair: Pair, package: str, ours: str, theirs: str) -> tuple[str, tuple[Command, ...]]:
    if not ours.startswith("~") and not theirs.startswith("~"):
        line = f"apt-get update && apt-get install -y --only-upgrade {quote(_debian(package))}"
        return "bring both to one release:", (Command("here", line, root=True), Command("there", line, root=True))
    mine = ours.startswith("~")
    folder = ours if mine else theirs
    left, right = _path(folder), f"{quote(pair.login)}:{_path(folder.removeprefix('~/'))}"
    if mine:
        copy = f"rsync -a {left}/ {right}/"
        help = f"if the one of {pair.here.name} is the right one, copy it (and build again):"
    else:
        copy = f"rsync -a {right}/ {left}/"
        help = f"the one of {pair.there.name} lies in its workspace; copy it here (and build again):"
    commands = [Command("here", copy)]
    if (pair.there if mine else pair.here).built:
        commands.append(Command("there" if mine else "here", "cd ~/catkin_ws && catkin_make"))
    return help, tuple(commands)


def _path(folder: str) -> str:
    return f"~/{quote(folder[2:])}" if folder.startswith("~/") else quote(folder)


RULES: tuple[Rule, ...] = (
    SideRule({"missing-package": "something that one of the two needs is not installed"}, check_missing),
    PairRule({"different-messages": "both know a message, but not as the same: topics do not connect"}, check_messages),
)
