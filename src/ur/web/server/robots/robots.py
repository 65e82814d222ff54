"""The interface to the robots that a page can change to, and its implementation for a single robot."""

from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Protocol

from ur.web.access.roles import Role
from ur.web.server.robots.peer import PeerError


@dataclass(frozen=True, slots=True)
class RobotEntry:
    """A robot in the list: `label` is its display name; `open` means that a server for it is running."""

    name: str
    label: str
    answers: bool
    open: bool


@dataclass(frozen=True, slots=True)
class ServerLogin:
    """The port of a robot's server, and a token for one login to it."""

    port: int
    token: str


class Robots(Protocol):
    """The robots, and their servers. Raises PeerError if one cannot be listed or opened."""

    @property
    def own(self) -> str:
        """The name of the robot that this server shows."""

    async def list(self) -> list[RobotEntry]:
        """List the robots."""

    async def invite(self, name: str, role: Role) -> ServerLogin:
        """Start a server for a listed robot if necessary, and create a token of a role for it."""

    async def close(self) -> None:
        """End the servers that were started."""


class OneRobot:
    """The robot of a server that knows no other one, such as the server on a robot itself."""

    def __init__(self, own: str, is_up: Callable[[], bool]) -> None:
        self.own, self._is_up = own, is_up

    async def list(self) -> list[RobotEntry]:
        """List this robot."""
        return [RobotEntry(self.own, self.own, self._is_up(), open=True)]

    async def invite(self, name: str, role: Role) -> ServerLogin:  # noqa: ARG002 - there is none
        """Refuse the request. Raises PeerError."""
        raise PeerError("this robot is not in the list")

    async def close(self) -> None:
        """Do nothing."""


def write_rows(rows: list[RobotEntry]) -> list[dict[str, object]]:
    """Return the rows as JSON."""
    return [asdict(each) for each in rows]
