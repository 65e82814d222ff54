"""Monitor of this computer's runs over their sockets, while a page displays them."""

import asyncio
import os
import signal
import sys
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass

from ur.run.clients.client import RunClient, RunUnreachable, connect_run
from ur.run.clients.protocol import (
    Notice,
    OutputLine,
    RunCommand,
    StatsSampled,
    StopRun,
    Synchronised,
    Watch,
    find_severity,
)
from ur.run.clients.run_state import NodeRow, RunState, apply_events, begin_state
from ur.run.record.registry import EndedRun, RunEntry, list_ended, list_runs, read_computer
from ur.run.supervisor.events import RestartNode, StartNode, StopNode
from ur.source.ansi import strip_styles
from ur.source.printable import printable
from ur.web.wire.run_requests import ChangeNode

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
            reading = [asyncio.create_task(_read(process.stdout, out)), asyncio.create_task(_read(process.stderr, err))]
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


KEPT = 1000
"""Lines that are kept of a run."""

_TAIL = 1 << 14  # bytes of a log file that are read back
_LONGEST = 1000  # characters of a line


@dataclass(frozen=True, slots=True)
class RunLogLine:
    """A line: the node that printed it, or "" for the run itself, and its severity, or "" if unknown."""

    node: str
    severity: str
    text: str


class LogLines:
    """The last lines of a run. Numbers of lines begin with 0 and have no gaps."""

    def __init__(self, kept: int = KEPT) -> None:
        self._lines: deque[RunLogLine] = deque(maxlen=kept)
        self.end = 0  # the number of the next line

    def add(self, node: str, severity: str, text: str) -> None:
        """Add a line; characters that are not printable are removed or shown as escapes."""
        clean = printable(strip_styles(text).replace("\t", "    "))
        self._lines.append(RunLogLine(node, severity, clean[:_LONGEST]))
        self.end += 1

    def since(self, number: int, most: int) -> tuple[int, list[RunLogLine]]:
        """Return at most `most` lines from a number on, and the number of the first: higher if lines were lost."""
        first = min(max(number, self.end - len(self._lines)), self.end)
        skipped = first - (self.end - len(self._lines))
        return first, [self._lines[skipped + index] for index in range(min(most, self.end - first))]


def read_lines(path: str, offset: int = 0) -> tuple[list[str], int]:
    """Return the whole lines of a log file from an offset on, and the offset at which they end.

    At most the last 16 KiB are read, from a whole line on; the list is empty if the file cannot be read.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC)
        try:
            size = os.fstat(descriptor).st_size
            begin = offset if 0 < offset <= size else 0  # a file that has become shorter is read from its beginning
            cut = size - begin > _TAIL
            begin = size - _TAIL if cut else begin
            data = os.pread(descriptor, _TAIL, begin)
        finally:
            os.close(descriptor)
    except OSError:
        return [], 0
    whole = data[: data.rfind(b"\n") + 1]
    lines = whole.decode("utf-8", "replace").splitlines()
    return lines[1:] if cut else lines, begin + len(whole)


Show = Callable[[str, str, str], None]
MOST_ENDED = 5
"""Runs that have ended, of which the page shows so many."""

_LAST_LINES = 12

_PERIOD = 1.0  # s between two searches for runs
_COMMANDS: Mapping[str, Callable[[str], RunCommand]] = {"start": StartNode, "stop": StopNode, "restart": RestartNode}


class _Watched:
    """A run with its connection."""

    def __init__(self, entry: RunEntry, client: RunClient) -> None:
        self.entry = entry
        self.state: RunState = begin_state()
        self.client = client
        self.lines = LogLines()
        self.read_back = ReadBack(self.lines.add)

    def logs(self) -> dict[str, str]:
        """The log files by node."""
        return {row.name: row.changed.log for row in self.state.rows if row.changed.log}


class RunWatcher:
    """Follows every run while a page holds it. `changed` is called after every change."""

    def __init__(self, environment: Mapping[str, str], changed: Callable[[], None]) -> None:
        self._environment, self._changed = environment, changed
        self._watched: dict[str, _Watched] = {}
        self._holders = 0
        self._task: asyncio.Task[None] | None = None
        self._ended: tuple[EndedRun, ...] = ()

    def hold(self) -> None:
        """Register a page that displays runs."""
        self._holders += 1
        if self._task is None:
            self._task = asyncio.create_task(self._run())

    def let_go(self) -> None:
        """Unregister a page; without any page, all connections are closed."""
        self._holders -= 1
        if self._holders == 0:
            self.close()

    def close(self) -> None:
        """Close all connections; the runs continue."""
        if self._task is not None:
            self._task.cancel()
            self._task = None
        for run in list(self._watched):
            self._drop(run)

    def describe(self) -> dict[str, object]:
        """Return the state of all runs for a page."""
        watched = sorted(self._watched.values(), key=lambda each: each.entry.started)
        return describe_runs([(each.entry, each.state) for each in watched], self._ended)

    def lines(self) -> Mapping[str, LogLines]:
        """Return the last lines of each run."""
        return {run: each.lines for run, each in self._watched.items()}

    def end_run(self, run: str, who: str) -> str:
        """Request the end of a run; return the reason why that is impossible, or ""."""
        watched = self._watched.get(run)
        if watched is None:
            return f"run {run} has ended"
        watched.client.send(StopRun(f"asked by the page of {who}"))
        return ""

    def change_node(self, request: ChangeNode) -> str:
        """Request the start, stop or restart of a node; return the reason why that is impossible, or ""."""
        watched = self._watched.get(request.run)
        if watched is None:
            return f"run {request.run} has ended"
        node = watched.state.find(request.node)
        if node is None:
            return f"run {request.run} has no node {request.node}"
        if node.changed.core:
            return f"{request.node} belongs to the master, and takes no commands"
        watched.client.send(_COMMANDS[request.action](request.node))
        return ""

    async def _run(self) -> None:
        while True:
            computer, uid = read_computer(), os.getuid()
            entries = {entry.run: entry for entry in list_runs(self._environment, uid, computer)}
            for run in self._watched.keys() - entries.keys():
                self._drop(run)
            for run, entry in entries.items():
                if run not in self._watched:
                    self._follow(entry)
            ended = tuple(list_ended(self._environment, uid, computer))
            if ended != self._ended:
                self._ended = ended
                self._changed()
            await asyncio.sleep(_PERIOD)

    def _follow(self, entry: RunEntry) -> None:
        try:
            client = connect_run(entry.folder)
        except RunUnreachable:
            return
        watched = self._watched[entry.run] = _Watched(entry, client)
        asyncio.get_running_loop().add_reader(client.fileno(), self._receive, watched)
        self._changed()

    def _receive(self, watched: _Watched) -> None:
        events = watched.client.receive()
        if events is None:
            self._drop(watched.entry.run)
            return
        watched.state = apply_events(watched.state, events)
        for event in events:
            if isinstance(event, OutputLine):
                watched.read_back.process(event.name, event.severity, event.text)
            elif isinstance(event, Notice):
                for line in event.text.splitlines():
                    watched.lines.add("", event.severity or "info", line)
            elif isinstance(event, Synchronised):
                watched.read_back.begin(watched.logs())
                watched.client.send(Watch(output=True, stats=True, readiness=True))
            elif isinstance(event, StatsSampled):  # the run sends lines to clients whose `Watch` has arrived
                watched.read_back.confirm(watched.logs())
        self._changed()

    def _drop(self, run: str) -> None:
        watched = self._watched.pop(run, None)
        if watched is not None:
            asyncio.get_running_loop().remove_reader(watched.client.fileno())
            watched.client.close()
            self._changed()


class ReadBack:
    """Combines the log files and new lines of one run: calls `show` once per line."""

    def __init__(self, show: Show) -> None:
        self._show = show
        self._offsets: dict[str, int] = {}
        self._held: list[tuple[str, str, str]] | None = []
        self._twice: dict[str, deque[str]] = {}

    def begin(self, logs: Mapping[str, str]) -> None:
        """Show the content of the log files, by node. The run's new lines are requested next."""
        for node, path in logs.items():
            self._read(node, path)

    def process(self, node: str, severity: str, text: str) -> None:
        """Process a line that the run has sent."""
        if self._held is not None:
            self._held.append((node, severity, text))
        elif not self._is_shown(node, text):
            self._show(node, severity, text)

    def confirm(self, logs: Mapping[str, str]) -> None:
        """Show the lines printed before the run began to send new ones. Later calls have no effect."""
        if self._held is None:
            return
        for node, path in logs.items():
            self._twice[node] = deque(self._read(node, path))
        held, self._held = self._held, None
        for line in held:
            self.process(*line)

    def _read(self, node: str, path: str) -> list[str]:
        lines, self._offsets[node] = read_lines(path, self._offsets.get(node, 0))
        for line in lines:
            self._show(node, find_severity(line), line)
        return lines

    def _is_shown(self, node: str, text: str) -> bool:
        """Return whether a received line was already read from the file; those before it were not sent."""
        waiting = self._twice.get(node)
        if not waiting:
            return False
        if text not in waiting:
            waiting.clear()
            return False
        while waiting.popleft() != text:
            pass
        return True


def describe_runs(active: Sequence[tuple[RunEntry, RunState]], ended: Sequence[EndedRun]) -> dict[str, object]:
    """Return the runs for display: active ones, oldest first, then ended ones, latest first."""
    return {
        "t": "runs",
        "runs": [_describe_run(*each) for each in active],
        "ended": [_describe_ended(each) for each in reversed(ended[-MOST_ENDED:])],
    }


def _describe_run(entry: RunEntry, state: RunState) -> dict[str, object]:
    return {
        "run": entry.run,
        "title": entry.title,
        "master": entry.master_uri,
        "started": entry.started,
        "detached": entry.detached,
        "stopping": state.cause,
        "lost": state.lost.seconds if state.lost is not None else None,
        "known": state.known,
        "nodes": [_describe_node(row) for row in state.rows],
    }


def _describe_node(node: NodeRow) -> dict[str, object]:
    hidden = ("log", "program")  # paths of this computer, which a browser cannot use
    fields = {name: value for name, value in asdict(node.changed).items() if name not in hidden}
    restart_in = None if node.changed.restart_in is None else round(node.changed.restart_in)
    measured = {"ready": node.ready, "missing": list(node.missing), "cpu": node.cpu, "memory": node.memory}
    return {**fields, "restart_in": restart_in, **measured}


def _describe_ended(run: EndedRun) -> dict[str, object]:
    return {
        "run": run.entry.run,
        "title": run.entry.title,
        "started": run.entry.started,
        "ended": run.ended,
        "exit_code": run.exit_code,
        "cause": run.cause,
        "lines": list(run.lines[-_LAST_LINES:]),
    }
