"""The one process that records: started, monitored, ended at a limit, and at the latest with the server."""

from __future__ import annotations

import asyncio
import os
import shutil
import signal
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from dataclasses import dataclass

from ur.source.printable import printable
from ur.web.server.recordings.store import RecordingBusyError, Store
from ur.web.server.recordings.topics import TopicSelection
from ur.web.server.recordings.writer import NoWriterError, RecordingWriter

_PERIOD = 0.5  # s between two checks of the limits
_MOST_ERRORS = 2000  # bytes of the process's output that are kept
_WITH_US = ("setpriv", "--pdeathsig", "INT", "--")  # it ends when the server is killed


class RecorderError(Exception):
    """The recording cannot start; the text is the reason, in one line."""


@dataclass(frozen=True, slots=True)
class RecordingLimits:
    """Limits: bytes of `all` recordings, bytes left `free` on the disk, and `seconds` of one recording.

    `patience` is the time in s between SIGINT and SIGKILL.
    """

    all: int = 2_000_000_000
    free: int = 1_000_000_000
    seconds: float = 3600.0
    patience: float = 5.0


@dataclass(frozen=True, slots=True)
class Running:
    """The recording in progress: names of its files begin with `stem`; `size` in bytes, `seconds` so far.

    `topics` is the number of chosen topics, 0 for all.
    """

    stem: str
    size: int
    seconds: float
    topics: int


def find_reason(limits: RecordingLimits, used: int, free: int, seconds: float) -> str:
    """Return the reason why a recording has to end, or must not begin; "" if there is none."""
    if used >= limits.all:
        return f"all recordings have {limits.all / 1e9:g} GB: delete some"
    if free < limits.free:
        return f"less than {limits.free / 1e9:g} GB is free on the disk"
    if seconds >= limits.seconds:
        return f"a recording takes {limits.seconds / 60:g} minutes at most"
    return ""


class Recorder:
    """Runs at most one process. `end` is the reason why the last recording ended, "" before."""

    def __init__(
        self,
        store: Store,
        writer: RecordingWriter,
        environment: Mapping[str, str],
        log: Callable[[str], None],
        limits: RecordingLimits | None = None,
    ) -> None:
        self._store, self._writer, self._log = store, writer, log
        self._environment, self._limits = environment, limits or RecordingLimits()
        self._task: asyncio.Task[None] | None = None
        self._asked: asyncio.Event = asyncio.Event()
        self._reason = ""
        self._closed = False
        self._stem, self._started, self._topics = "", 0.0, 0
        self.end = ""

    @property
    def running(self) -> Running | None:
        """The recording in progress."""
        if self._task is None:
            return None
        return Running(self._stem, self._store.measure(self._stem), time.monotonic() - self._started, self._topics)

    def start(self, selection: TopicSelection) -> None:
        """Start recording. Raises RecorderError."""
        if self._task is not None:
            raise RecorderError("a recording is under way: stop it first")
        if self._closed:
            raise RecorderError("the server ends")
        with ExitStack() as stack:
            try:
                self._store.prepare()
                stack.enter_context(self._store.lock())
                self._store.adopt()
                used, free, stem = self._store.measure(), self._store.free(), self._store.new_stem()
                command = self._writer.make_command(self._store.folder / stem, selection)
            except RecordingBusyError:
                raise RecorderError("another page of this computer records: stop it there") from None
            except NoWriterError as problem:
                raise RecorderError(str(problem)) from None
            except OSError as problem:
                raise RecorderError(f"{self._store.folder}: {(problem.strerror or str(problem)).lower()}") from None
            if reason := find_reason(self._limits, used, free, 0.0):
                raise RecorderError(reason)
            self._stem, self._started = stem, time.monotonic()
            self._topics, self._reason, self._asked = len(selection.topics), "", asyncio.Event()
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
            self._log(f"recording {self._stem} has ended: {self.end}")

    async def _record(self, command: list[str]) -> str:
        """Run the process; return the reason of its end."""
        process = await asyncio.create_subprocess_exec(
            *(*(_WITH_US if shutil.which(_WITH_US[0]) else ()), *command),
            stdin=asyncio.subprocess.DEVNULL,
            stdout=asyncio.subprocess.DEVNULL,
            stderr=asyncio.subprocess.PIPE,
            env=dict(self._environment),
            cwd=self._store.folder,
            umask=0o077,
            start_new_session=True,  # Ctrl-C is for this process, which ends that one
        )
        errors = bytearray()
        assert process.stderr is not None
        reading = asyncio.create_task(_read(process.stderr, errors))
        waits = (asyncio.ensure_future(process.wait()), asyncio.ensure_future(self._asked.wait()))
        try:
            while True:
                done, _ = await asyncio.wait(waits, timeout=_PERIOD, return_when=asyncio.FIRST_COMPLETED)
                if waits[0] in done:
                    await asyncio.wait((reading,), timeout=_PERIOD)
                    return f"rosbag has ended by itself: {_last_line(errors) or f'exit code {process.returncode}'}"
                if waits[1] in done:
                    return self._reason
                used, free = self._store.measure(), self._store.free()
                if reason := find_reason(self._limits, used, free, time.monotonic() - self._started):
                    return reason
        finally:
            await _end(process, self._limits.patience)
            for task in (*waits, reading):
                task.cancel()
            await asyncio.gather(*waits, reading, return_exceptions=True)


async def _read(stream: asyncio.StreamReader, into: bytearray) -> None:
    while part := await stream.read(1 << 12):
        into += part
        del into[:-_MOST_ERRORS]


def _last_line(errors: bytearray) -> str:
    lines = errors.decode("utf-8", "replace").strip().splitlines()
    return printable(lines[-1])[:200] if lines else ""


async def _end(process: asyncio.subprocess.Process, patience: float) -> None:
    """Interrupt a process, so that it completes its files, and kill it after `patience` s."""
    for number in (signal.SIGINT, signal.SIGKILL):
        if process.returncode is not None:
            return
        with suppress(ProcessLookupError):
            os.killpg(process.pid, number)
        with suppress(asyncio.TimeoutError):
            await asyncio.wait_for(process.wait(), patience)
