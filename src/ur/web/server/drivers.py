"""Pages that may drive: a separate web socket each, for small messages, so that commands never wait behind a map."""

import asyncio
import itertools
import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Protocol

from aiohttp import WSCloseCode, web

from ur.web.wire.map_requests import DeleteZone, DrawWalls, ForgetPlace, NamePlace, PutZone, RestoreWalls, SaveMap
from ur.web.wire.requests import (
    AskForLease,
    GoalRequest,
    GoTo,
    LimitSpeed,
    ReleaseAll,
    Request,
    Stick,
    StopAll,
    SwitchObstacleStop,
)

_MOST_NUMBERS = 200
_LOGGED = (
    DeleteZone, ReleaseAll, StopAll, ForgetPlace, GoTo, AskForLease, LimitSpeed, NamePlace, PutZone,
    RestoreWalls, SaveMap, SwitchObstacleStop,
)  # fmt: skip


class DriverPage(Protocol):
    """A page, or a viewer, that may drive."""

    client: str
    socket: web.WebSocketResponse

    def challenge(self, text: str) -> None:
        """Queue a challenge, in place of an older one."""

    def answer(self, value: Mapping[str, object]) -> None:
        """Process an answer of the robot's process."""


class DrivingPage:
    """One page. Only the newest unsent challenge is sent to it."""

    def __init__(self, client: str, socket: web.WebSocketResponse) -> None:
        self.client, self.socket = client, socket
        self._challenge: str | None = None
        self._answers: list[str] = []
        self._due = asyncio.Event()

    def challenge(self, text: str) -> None:
        """Queue a challenge, in place of an older one."""
        self._challenge = text
        self._due.set()

    def answer(self, value: Mapping[str, object]) -> None:
        """Queue an answer; if more than a hundred wait, the oldest are dropped."""
        self._answers = [*self._answers[-99:], json.dumps(value)]
        self._due.set()

    async def run(self) -> None:
        """Send until the page disconnects."""
        with suppress(ConnectionError):
            while not self.socket.closed:
                if self._answers:
                    await self.socket.send_str(self._answers.pop(0))
                elif self._challenge is not None:
                    text, self._challenge = self._challenge, None
                    await self.socket.send_str(text)
                else:
                    self._due.clear()
                    await self._due.wait()


class DrivingPages:
    """All pages that may drive, by client id. `send` forwards a message to the robot's process."""

    def __init__(self, send: Callable[[Mapping[str, object]], None]) -> None:
        self._send = send
        self._drivers: dict[str, DriverPage] = {}
        self._arrivals: dict[str, dict[str, object]] = {}
        self._numbers: dict[str, int] = {}  # of the pages of a browser, by client id

    async def add(self, driver: DriverPage, name: str, computer: str, *, once: bool = False) -> str:
        """Register a page and close an older connection of the same page; return the page's name.

        `computer` identifies its browser. `once`: it does not return as the same client, so its lease is not kept after
        it ends. The name has a number if the browser has several pages.
        """
        client = driver.client
        before = self._drivers.pop(client, None)
        if before is not None:
            self._send({"do": "leave", "page": client})
            with suppress(ConnectionError, asyncio.TimeoutError):
                await asyncio.wait_for(before.socket.close(code=WSCloseCode.GOING_AWAY, message=b"opened again"), 1.0)
        self._drivers[client] = driver
        # The previous number of a page, or the lowest one that no other page of its browser has
        others = (each for each, arrival in self._arrivals.items() if arrival["computer"] == computer)
        taken = {self._numbers[each] for each in others if each != client}
        number = self._numbers.pop(client, 1)
        if number in taken:
            number = next(each for each in itertools.count(1) if each not in taken)
        self._numbers[client] = number
        while len(self._numbers) > _MOST_NUMBERS and next(iter(self._numbers)) not in self._arrivals:
            del self._numbers[next(iter(self._numbers))]
        name = _number_name(name, number)
        self._arrivals[client] = {"do": "come", "page": client, "name": name, "computer": computer, "once": once}
        self._send(self._arrivals[client])
        return name

    def rename(self, computer: str, name: str) -> None:
        """Rename the pages of a browser."""
        for client, arrival in self._arrivals.items():
            if arrival["computer"] == computer:
                arrival["name"] = _number_name(name, self._numbers[client])
                self._send({"do": "name", "page": client, "name": arrival["name"]})

    def sockets(self) -> list[web.WebSocketResponse]:
        """List the web sockets of all pages."""
        return [each.socket for each in self._drivers.values()]

    def remove(self, driver: DriverPage) -> None:
        """Unregister a page that has disconnected."""
        if self._drivers.get(driver.client) is driver:
            del self._drivers[driver.client]
            self._arrivals.pop(driver.client, None)
            self._send({"do": "leave", "page": driver.client})

    def come_again(self) -> None:
        """Send the present drivers to a new robot process."""
        for arrival in self._arrivals.values():
            self._send(arrival)

    def process(self, message: Mapping[str, object]) -> None:
        """Process a message of the robot's process: a challenge for all pages, or an answer for one."""
        if "n" in message:
            text = json.dumps({"n": message["n"]}, separators=(",", ":"))
            for driver in self._drivers.values():
                driver.challenge(text)
        else:
            found, answer = self._drivers.get(str(message.get("page", ""))), message.get("m")
            if found is not None and isinstance(answer, Mapping):
                found.answer(answer)


def _number_name(name: str, number: int) -> str:
    return name if number == 1 else f"{name}, page {number}"


def describe_request(request: Request, text: str, hold: int) -> str:
    """Describe a request of a page for the log; '' if it is not logged.

    `hold` is the number of the page's previous press of the stick.
    """
    match request:
        case Stick():
            return "" if request.hold == hold else "stick"
        case GoalRequest():
            heading = "" if request.yaw is None else f" {request.yaw:.2f}"
            return f"goal {request.x:.2f} {request.y:.2f}{heading}"
        case DrawWalls():
            return f"changes walls of map {request.map}, {len(request.strokes)} strokes"
    return text if isinstance(request, _LOGGED) else ""
