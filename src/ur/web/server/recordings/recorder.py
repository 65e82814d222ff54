"""The recording of a page: the node of `ur record`, monitored, ended at a limit, and at the latest with the server."""

import asyncio
import os
import secrets
import signal
import time
from collections import deque
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path

from ur.source.printable import printable
from ur.system.child_processes import read_errors, start_child, wait_or_kill
from ur.system.ros import node_command
from ur.web.server.recordings.store import RecordingBusyError, Store

_MODULE = "ur_nodes.recorder.record_node"
_PERIOD = 0.5  # s between two checks of the limits
_FREE = 1000  # MB that stay free on the disk


class RecorderError(Exception):
    """The recording cannot start; the text is the reason, in one line."""


@dataclass(frozen=True, slots=True)
class RecordingLimits:
    """Limits: bytes of `all` recordings, and `seconds` of one. `patience`: s between SIGINT and SIGKILL."""

    all: int = 2_000_000_000
    seconds: float = 3600.0
    patience: float = 12.0


@dataclass(frozen=True, slots=True)
class Running:
    """The recording in progress: `size` in bytes, `seconds` so far, `topics` the number of chosen ones, 0 for all."""

    size: int
    seconds: float
    topics: int


def make_command(environment: Mapping[str, str], folder: Path, topics: Sequence[str]) -> list[str]:
    """Return the command that records topics, without any all but pictures and clouds, into a folder."""
    chosen = f"_topics:={' '.join(topics)}" if topics else "_pictures:=false"
    name = f"__name:=page_recorder_{secrets.token_hex(4)}"
    return [*node_command(environment), _MODULE, name, f"_folder:={folder}", f"_free_megabytes:={_FREE}.0", chosen]


def find_reason(limits: RecordingLimits, used: int, seconds: float) -> str:
    """Return the reason why a recording has to end, or must not begin; "" if there is none."""
    if used >= limits.all:
        return f"all recordings have {limits.all / 1e9:g} GB: delete some"
    if seconds >= limits.seconds:
        return f"a recording takes {limits.seconds / 60:g} minutes at most"
    return ""


class Recorder:
    """Runs at most one process. `end` is the reason why the last recording ended, "" before."""

    def __init__(
        self,
        store: Store,
        environment: Mapping[str, str],
        log: Callable[[str], None],
        limits: RecordingLimits | None = None,
        command: Callable[[Mapping[str, str], Path, Sequence[str]], list[str]] = make_command,
    ) -> None:
        self._store, self._log, self._make_command = store, log, command
        self._environment, self._limits = environment, limits or RecordingLimits()
        self._task: asyncio.Task[None] | None = None
        self._asked: asyncio.Event = asyncio.Event()
        self._reason = ""
        self._closed = False
        self._started, self._topics = 0.0, 0
        self._before: Collection[str] = ()
        self.end = ""

    @property
    def running(self) -> Running | None:
        """The recording in progress."""
        if self._task is None:
            return None
        return Running(self._store.measure(self._before), time.monotonic() - self._started, self._topics)

    def start(self, topics: Sequence[str]) -> None:
        """Start recording topics, or all without any. Raises RecorderError."""
        if self._task is not None:
            raise RecorderError("a recording is under way: stop it first")
        if self._closed:
            raise RecorderError("the server ends")
        with ExitStack() as stack:
            try:
                self._store.prepare()
                stack.enter_context(self._store.lock())
                self._store.adopt()
            except RecordingBusyError:
                raise RecorderError("another page of this computer records: stop it there") from None
            except OSError as problem:
                raise RecorderError(f"{self._store.folder}: {(problem.strerror or str(problem)).lower()}") from None
            if reason := find_reason(self._limits, self._store.measure(), 0.0):
                raise RecorderError(reason)
            self._before, self._started = self._store.names(), time.monotonic()
            self._topics, self._reason, self._asked = len(topics), "", asyncio.Event()
            command = self._make_command(self._environment, self._store.folder, topics)
            self._task = asyncio.create_task(self._run(command, stack.pop_all()))

    async def stop(self, reason: str) -> bool:
        """End the recording, and wait until its files are complete. Return whether there was one."""
        task = self._task
        if task is None:
            return False
        self._reason = self._reason or reason
        self._asked.set()
        await asyncio.shield(asyncio.gather(task, return_exceptions=True))
        return True

    async def close(self) -> None:
        """End the recording permanently."""
        self._closed = True
        await self.stop("the server has ended")

    async def _run(self, command: list[str], stack: ExitStack) -> None:
        self.end = ""
        try:
            with stack:
                self.end = await self._record(command)
                self._store.adopt()
        except OSError as problem:
            self.end = f"{command[0]}: {(problem.strerror or str(problem)).lower()}"
        finally:
            self._task = None
            self._log(f"the recording has ended: {self.end}")

    async def _record(self, command: list[str]) -> str:
        """Run the process; return the reason of its end."""
        process = await start_child(command, (), self._environment)
        errors: deque[str] = deque(maxlen=1)
        reading = asyncio.create_task(read_errors(process, errors.append))
        waits = (asyncio.ensure_future(process.wait()), asyncio.ensure_future(self._asked.wait()))
        try:
            while True:
                done, _ = await asyncio.wait(waits, timeout=_PERIOD, return_when=asyncio.FIRST_COMPLETED)
                if waits[0] in done:
                    await asyncio.wait((reading,), timeout=_PERIOD)
                    reason = printable(errors[0])[:200] if errors else f"exit code {process.returncode}"
                    return f"the recorder has ended by itself: {reason}"
                if waits[1] in done:
                    return self._reason
                if reason := find_reason(self._limits, self._store.measure(), time.monotonic() - self._started):
                    return reason
        finally:
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGINT)  # it completes its files
            await wait_or_kill(process, self._limits.patience)
            for task in (*waits, reading):
                task.cancel()
            await asyncio.gather(*waits, reading, return_exceptions=True)
