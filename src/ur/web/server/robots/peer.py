"""Requests and answers between two servers of this computer, as lines of JSON over a private socket pair."""

import asyncio
import json
from collections.abc import Awaitable, Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass

from ur.source.foreign.json_values import convert_json, read_json
from ur.system.child_processes import PendingAnswers

LONGEST_LINE = 1 << 16
_ANSWER_LIMIT = 30.0  # s: a server may have to be started first

Handler = Callable[[Mapping[str, object]], Awaitable[object]]


@dataclass(frozen=True, slots=True)
class _Message:
    """A request `ask` with its value, or the `answer` to one: its value, or the problem."""

    ask: int | None = None
    answer: int | None = None
    value: object = None
    problem: str | None = None


class PeerError(Exception):
    """A request that was refused or not answered, with the reason for users."""


class Peer:
    """One end of the connection. `handle` answers requests of the other end, which receives any PeerError it raises.

    `ended` is true when the other end has ended.
    """

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, handle: Handler) -> None:
        self._reader, self._writer, self._handle = reader, writer, handle
        self._answers = PendingAnswers[object](PeerError)
        self._tasks: set[asyncio.Task[None]] = set()
        self.ended = False

    async def run(self) -> None:
        """Serve until the other end has ended. All pending requests then fail."""
        try:
            with suppress(ConnectionError, ValueError):  # ValueError: a line that is too long, or no JSON
                while line := await self._reader.readline():
                    self._take(read_json(line, _Message, LONGEST_LINE))
        finally:
            self.ended = True
            for task in self._tasks:
                task.cancel()
            self._answers.fail("the server of this robot has ended")
            self._writer.close()

    async def ask(self, request: Mapping[str, object]) -> object:
        """Return the answer to a request, a JSON value. Raises PeerError."""
        if self.ended:
            raise PeerError("the server of this robot has ended")
        number, answer = self._answers.add()
        try:
            self._write({"ask": number, "value": dict(request)})
            return await asyncio.wait_for(answer, _ANSWER_LIMIT)
        except asyncio.TimeoutError:
            raise PeerError("the server of this robot does not answer") from None

    def close(self) -> None:
        """Make `run` return on both ends."""
        self._writer.close()

    def _write(self, message: Mapping[str, object]) -> None:
        self._writer.write(json.dumps(message, separators=(",", ":")).encode() + b"\n")

    def _take(self, message: _Message) -> None:
        if message.ask is not None:
            request = convert_json(message.value, dict[str, object])
            task = asyncio.create_task(self._answer(message.ask, request))
            self._tasks.add(task)
            task.add_done_callback(self._tasks.discard)
        else:
            self._answers.give(message.answer, message.value, message.problem)

    async def _answer(self, number: int, request: Mapping[str, object]) -> None:
        try:
            self._write({"answer": number, "value": await self._handle(request)})
        except PeerError as problem:
            self._write({"answer": number, "problem": str(problem)})
