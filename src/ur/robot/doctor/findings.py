"""Values of the doctor: two computers, findings, and the commands that fix them."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from ur.devices.known import DeviceSnapshot, Expected
from ur.robot.doctor.side import Side
from ur.robot.ssh.shell import quote

Where = Literal["local", "remote"]
_SHELL_SIGNS = re.compile(r"[;&|<>$`(){}*?~]")


@dataclass(frozen=True, slots=True)
class FixCommand:
    """One line for a POSIX shell that fixes a finding, or helps to: on this computer or the robot, as user or as root.

    `safe` means that it can do no harm, so that `--fix` runs it. The printed text is the one that `--fix` runs.
    """

    where: Where
    line: str
    root: bool = False
    safe: bool = False

    @property
    def typed(self) -> str:
        """The command as a user types it: with sudo if root is needed."""
        if not self.root:
            return self.line
        return f"sudo sh -c {quote(self.line)}" if _SHELL_SIGNS.search(self.line) else f"sudo {self.line}"


@dataclass(frozen=True, slots=True)
class Finding:
    """A problem: its kind (a stable id), a description, and advice or commands that fix it, to be run in order."""

    rule: str
    message: str
    help: str = ""
    commands: tuple[FixCommand, ...] = ()

    @property
    def fixable(self) -> bool:
        """Return whether `--fix` runs a command for it."""
        return any(command.safe for command in self.commands)


@dataclass(frozen=True, slots=True)
class Owner:
    """The process that runs a node: its computer, its process id and command line, and its systemd unit, if any."""

    where: Where
    pid: int
    words: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class AdvertisedNode:
    """A node and the host in its registered address, with the address to which each computer resolves that host."""

    node: str
    host: str
    local: frozenset[str]
    remote: frozenset[str]
    owner: Owner | None = None


@dataclass(frozen=True, slots=True)
class ComputerPair:
    """Both computers.

    `offset` (s) is how far the robot's clock is ahead. `way_back` is ssh's output of a login from the robot to this
    computer, '' on success. `reaches_...` tell for each direction whether a connection to a free port succeeds.
    `key_refused`: the robot requested a password although this computer has a key. `known`: the robot was set up from
    this computer. `selected`: `ur use` has selected it. `twins`: by host name, the addresses of a computer that
    zeroconf renamed with -2 after a name conflict. `login`: USER@HOST by which the robot was reached. `robot_login` is
    False if the user did not allow the robot to log in to this computer. `devices` are the robot's, `expected` those
    that its base needs.
    """

    local: Side
    remote: Side
    offset: float
    way_back: str
    reaches_remote: bool
    reaches_local: bool
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
        """Return for both computers: which one it is, its facts, and the facts of the other."""
        return ("local", self.local, self.remote), ("remote", self.remote, self.local)
