"""The interface to the robots that a page can change to, and the robot of a server that knows no other."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Protocol

from ur.web.access.roles import Role
from ur.web.server.robots.peer import PeerError


@dataclass(frozen=True, slots=True)
class RobotEntry:
    """A robot in the list: `label` is its name for people; `open` whether a server for it runs."""

    name: str
    label: str
    answers: bool
    open: bool


@dataclass(frozen=True, slots=True)
class ServerLogin:
    """The port of a robot's server, and a token for one login there."""

    port: int
    token: str


class Robots(Protocol):
    """The robots, and their servers. Raises PeerError where one cannot be listed or opened."""

    @property
    def own(self) -> str:
        """The name of the robot that this server shows."""

    async def list(self) -> list[RobotEntry]:
        """List the robots."""

    async def invite(self, name: str, role: Role) -> ServerLogin:
        """Have a server run for a robot of the list, and make a token of a role there."""

    async def close(self) -> None:
        """End the servers that were started."""


class OneRobot:
    """The robot of a server that knows no other, such as the one on a robot itself."""

    def __init__(self, own: str, is_up: Callable[[], bool]) -> None:
        self.own, self._is_up = own, is_up

    async def list(self) -> list[RobotEntry]:
        """List this robot."""
        return [RobotEntry(self.own, self.own, self._is_up(), open=True)]

    async def invite(self, name: str, role: Role) -> ServerLogin:  # noqa: ARG002 - there is none
        """Refuse. Raises PeerError."""
        raise PeerError("this robot is not in the list")

    async def close(self) -> None:
        """End nothing."""


def write_rows(rows: list[RobotEntry]) -> list[dict[str, object]]:
    """Rows as JSON."""
    return [asdict(each) for each in rows]
