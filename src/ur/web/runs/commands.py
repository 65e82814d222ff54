"""Commands of `ur` in separate processes: they take seconds, and must not delay driving."""

import asyncio
import os
import signal
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass

MOST_OUTPUT = 1 << 21
"""Bytes of output that are kept of a command."""

_AT_ONCE = 2  # commands that run at once
_PATIENCE = 5.0  # s between SIGINT and SIGKILL
_REST = 1.0  # s for output after the end: a process that has detached itself may hold the pipe


@dataclass(frozen=True, slots=True)
class EndedCommand:
    """A command that has ended: its exit code, and its output. `late`: it was ended after its time limit."""

    code: int
    out: str
    err: str
    late: bool = False


class CommandQueue:
    """Runs commands, at most two at once. They get no input and no terminal."""

    def __init__(self, environment: Mapping[str, str]) -> None:
        kept = {name: value for name, value in environment.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
        self._environment = {**kept, "NO_COLOR": "1"}
        self._turns = asyncio.Semaphore(_AT_ONCE)

    async def run(self, *arguments: str, limit: float) -> EndedCommand:
        """Run `ur` with these arguments for at most `limit` s. On cancellation, the command is interrupted."""
        async with self._turns:
            process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-I", "-m", "ur", *arguments),
                stdin=asyncio.subprocess.DEVNULL,
                stdout=asyncio.subprocess.PIPE,
                stderr=asyncio.subprocess.PIPE,
                env=self._environment,
                start_new_session=True,
            )
            assert process.stdout is not None
            assert process.stderr is not None
            out, err = bytearray(), bytearray()
            reading = [
                asyncio.create_task(_read(process.stdout, out)),
                asyncio.create_task(_read(process.stderr, err)),
            ]
            late = False
            try:
                await asyncio.wait_for(process.wait(), limit)
                await asyncio.wait(reading, timeout=_REST)
            except asyncio.TimeoutError:
                late = True
            finally:
                if process.returncode is None:
                    await _end(process)
                for task in reading:
                    task.cancel()
                await asyncio.gather(*reading, return_exceptions=True)
            return EndedCommand(
                process.returncode or 0, out.decode("utf-8", "replace"), err.decode("utf-8", "replace"), late
            )


async def _read(stream: asyncio.StreamReader, into: bytearray) -> None:
    while part := await stream.read(1 << 16):
        into += part[: max(0, MOST_OUTPUT - len(into))]


async def _end(process: asyncio.subprocess.Process) -> None:
    """Interrupt a command and all processes of its session; kill them if it does not end."""
    for number in (signal.SIGINT, signal.SIGKILL):
        with suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        with suppress(asyncio.TimeoutError):
            await asyncio.wait_for(process.wait(), _PATIENCE)
            return
