"""Values of the doctor: two computers, findings, and the commands that fix them. Values only."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from ur.devices.device import DeviceSnapshot, Expected
from ur.robot.doctor.side import Side
from ur.robot.ssh.shell import quote

Where = Literal["here", "there"]
_SHELL_SIGNS = re.compile(r"[;&|<>$`(){}*?~]")


@dataclass(frozen=True, slots=True)
class FixCommand:
    """One line for a POSIX shell that cures, or helps to: on this computer or on the robot, as its user or as root.

    `safe`: it can do no harm, so that `--fix` runs it. What is printed and what `--fix` runs are the same text.
    """

    where: Where
    line: str
    root: bool = False
    safe: bool = False

    @property
    def typed(self) -> str:
        """As a person types it: with sudo where root is needed."""
        if not self.root:
            return self.line
        return f"sudo sh -c {quote(self.line)}" if _SHELL_SIGNS.search(self.line) else f"sudo {self.line}"


@dataclass(frozen=True, slots=True)
class Finding:
    """Something that is wrong: its kind (a stable id), what is the matter, and advice or commands that fix it.

    The commands are meant one after the other.
    """

    rule: str
    message: str
    help: str = ""
    commands: tuple[FixCommand, ...] = ()

    @property
    def fixable(self) -> bool:
        """Return whether `--fix` does something about it."""
        return any(command.safe for command in self.commands)


@dataclass(frozen=True, slots=True)
class Owner:
    """The process behind a node: where it runs, its number and command line, and its systemd unit, if it has one."""

    where: Where
    pid: int
    words: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class AdvertisedNode:
    """A node and the host in the address under which it is registered, with what each computer takes that name for."""

    node: str
    host: str
    here: frozenset[str]
    there: frozenset[str]
    owner: Owner | None = None


@dataclass(frozen=True, slots=True)
class ComputerPair:
    """Both computers. `offset` (s): how far the robot's clock is ahead.

    `way_back` is ssh's answer from there to here, '' when it logged in. `reaches_...` are, for each direction, whether
    a connection to a free port arrives. `key_refused`: the robot wanted a password although we have a key. `known`: the
    robot was set up from here. `selected`: `ur use` means it. `twins`: by host name, the addresses of a computer to
    which zeroconf gave the name with -2 since it was taken. `login`: USER@HOST by which the robot was reached.
    `robot_login` is False where the user did not let the robot log in to this computer. `devices` are the robot's,
    `expected` those that its base needs.
    """

    here: Side
    there: Side
    offset: float
    way_back: str
    reaches_there: bool
    reaches_here: bool
    key_refused: bool = False
    advertised: tuple[AdvertisedNode, ...] = ()
    known: bool = False
    selected: bool = False
    twins: Mapping[str, frozenset[str]] = field(default_factory=dict)
    login: str = ""
    robot_login: bool = True
    devices: DeviceSnapshot | None = None
    expected: tuple[Expected, ...] = ()

    def sides(self) -> tuple[tuple[Where, Side, Side], tuple[Where, Side, Side]]:
        """Both: where each is, itself, and the other."""
        return ("here", self.here, self.there), ("there", self.there, self.here)
