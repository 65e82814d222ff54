"""`Robot` for programs that use asyncio."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable
from contextlib import suppress
from functools import partial
from types import TracebackType
from typing import Any, TypeVar

from ur_nodes.client.script.errors import Interrupted
from ur_nodes.client.script.robot import CAMERA, Robot, Waypoint
from ur_nodes.exploration.status import ExploreStatus
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.values import Battery, Map, PackedPicture, Scan

Value = TypeVar("Value")


class AsyncRobot:
    """A `Robot` for `async with AsyncRobot() as robot:`, with the same methods, units and errors.

    One call at a time may be under way. A task that is cancelled while it drives stops the
    robot before the cancellation goes on.
    """

    def __init__(self, name: str = "", **given: Any) -> None:
        """See Robot."""
        self._robot = Robot(name, **given)

    async def __aenter__(self) -> AsyncRobot:
        await self._run(self._robot.__enter__)
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self._run(partial(self._robot.__exit__, kind, problem, trace))

    async def pose(self) -> Pose2:
        """See `Robot.pose`."""
        return await self._run(self._robot.pose)

    async def scan(self) -> Scan:
        """See `Robot.scan`."""
        return await self._run(self._robot.scan)

    async def nearest(self, width: float = 360.0, direction: float = 0.0) -> float:
        """See `Robot.nearest`."""
        return await self._run(partial(self._robot.nearest, width, direction))

    async def map(self) -> Map:
        """See `Robot.map`."""
        return await self._run(self._robot.map)

    async def battery(self) -> Battery:
        """See `Robot.battery`."""
        return await self._run(self._robot.battery)

    async def picture(self, topic: str = CAMERA) -> PackedPicture:
        """See `Robot.picture`."""
        return await self._run(partial(self._robot.picture, topic))

    async def events(self) -> tuple[str, ...]:
        """See `Robot.events`."""
        return await self._run(self._robot.events)

    async def go_to(self, x: float, y: float, heading_degrees: float | None = None) -> Pose2:
        """See `Robot.go_to`."""
        return await self._run(partial(self._robot.go_to, x, y, heading_degrees))

    async def follow(self, waypoints: Iterable[Waypoint]) -> list[Pose2]:
        """See `Robot.follow`."""
        return await self._run(partial(self._robot.follow, list(waypoints)))

    async def drive(self, forward: float, turn: float, seconds: float) -> None:
        """See `Robot.drive`."""
        await self._run(partial(self._robot.drive, forward, turn, seconds))

    async def stop(self) -> None:
        """See `Robot.stop`."""
        await self._run(self._robot.stop)

    async def explore(self) -> ExploreStatus:
        """See `Robot.explore`."""
        return await self._run(self._robot.explore)

    async def _run(self, call: Callable[[], Value]) -> Value:
        made = asyncio.get_running_loop().run_in_executor(None, call)
        try:
            return await asyncio.shield(made)
        except asyncio.CancelledError:
            self._robot.interrupt()
            with suppress(Interrupted, Exception):
                await made
            raise
