"""Stored maps of this computer for the page: list, new names and deletion, by `ur maps` and with its checks."""

import asyncio
import math
import time

from ur.maps.names import check_map_name
from ur.source.diagnostic import UserError
from ur.web.runs.commands import CommandQueue
from ur.web.runs.programs import ProgramsError, explain_failure, parse_output

_READING = 60.0  # time limit (s) of a command
_CHANGING = 20.0
_MOST_MAPS = 200
_SHOWN = ("name", "changed", "width", "height", "places", "latest", "problem", "picture")


class StoredMaps:
    """Lists and changes stored maps. Each method raises ProgramsError."""

    def __init__(self, commands: CommandQueue) -> None:
        self._commands = commands
        self._reading = asyncio.Lock()
        self._read_at = -math.inf
        self._listed: list[dict[str, object]] = []

    async def list_all(self) -> list[dict[str, object]]:
        """List the maps with a small picture each, as `ur maps --json --pictures` does, without paths."""
        asked = time.monotonic()
        async with self._reading:
            if self._read_at < asked:  # waiting callers share the answer of the first one
                began = time.monotonic()
                done = await self._commands.run("maps", "--json", "--pictures", limit=_READING)
                found = parse_output(done, list[dict[str, object]], "the maps cannot be listed")
                self._listed = [{key: each.get(key) for key in _SHOWN} for each in found[:_MOST_MAPS]]
                self._read_at = began
            return self._listed

    async def rename(self, before: object, after: object) -> None:
        """Rename a map; its places stay with it."""
        words = read_name(before), read_name(after)
        await self._change(f"map {words[0]!r} was not renamed", "rename", *words)

    async def delete(self, name: object) -> None:
        """Delete a map permanently."""
        word = read_name(name)
        await self._change(f"map {word!r} was not deleted", "delete", word, "--yes")

    async def _change(self, otherwise: str, *words: str) -> None:
        done = await self._commands.run("maps", *words, limit=_CHANGING)
        if done.code != 0 or done.late:
            raise ProgramsError(explain_failure(done, otherwise))


def read_name(value: object) -> str:
    """Return the name of a map in a request, which cannot be a path or an option. Raises ProgramsError."""
    if not isinstance(value, str):
        raise ProgramsError("name: expected the name of a map")
    try:
        return check_map_name(value)
    except UserError as problem:
        raise ProgramsError(str(problem)) from None
