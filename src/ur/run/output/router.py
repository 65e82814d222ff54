"""Routing of node output: to log files, to the display, and the last lines to crash reports."""

from __future__ import annotations

import os
import select
import time
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING

from ur.run.output.console import Console
from ur.run.output.log_rotation import LogRotation
from ur.run.output.node_output import FLOOD_PAUSE, KEPT_LINES, LineSplitter, Stream, make_printable, read_last_lines
from ur.run.process.command import UnitProgram
from ur.source.data_classes import dataclass

if TYPE_CHECKING:
    from ur.run.clients.protocol import OutputSource

MOST_TAIL = 256 * 1024  # bytes of a log that are read back at once; faster output is unreadable anyway


@dataclass(slots=True)
class _Output:
    path: str
    log: int
    streams: list[Stream]
    recent: deque[str]
    direct: bool = False  # some output is written to the log directly by the node
    read_back: int = 0
    splitter: LineSplitter | None = None


class NodeOutputs:
    """The outputs of all nodes of a run, by name."""

    def __init__(
        self,
        poll: select.poll,
        folder: str,
        console: Console,
        report: Callable[[str, OutputSource, str], None],
        *,
        unattended: bool,
        rotation: LogRotation,
    ) -> None:
        """Create the outputs: log files in `folder`, lines to `console` and `report`.

        `unattended`: lines go to the log files only.
        """
        self._poll = poll
        self._folder = folder
        self._console = console
        self._report = report
        self._unattended = unattended
        self._rotation = rotation
        self._outputs: dict[str, _Output] = {}
        self._streams: dict[int, Stream] = {}
        self._paused: dict[int, float] = {}  # descriptors that are not polled until a time
        self._null = -1  # standard input of every node

    def open(self, program: UnitProgram) -> None:
        """Create or continue the log file of a node that is about to start."""
        name = program.unit.name
        before = self._outputs.get(name)
        if before is not None:
            self._close(before)
        path = self.find_path(program)
        self._rotation.add(program.log_name)
        log = _open_log(path, fresh=before is None)
        recent = before.recent if before else deque[str](maxlen=KEPT_LINES)
        output = _Output(path, log, [], recent)
        if before is not None:
            output.read_back, output.splitter = before.read_back, before.splitter
        self._outputs[name] = output

    def wire(self, program: UnitProgram) -> tuple[tuple[int, int, int], list[int]]:
        """Return the stdio descriptors of an opened node, and those to close after its start."""
        name = program.unit.name
        output = self._outputs[name]
        if self._null < 0:
            self._null = os.open(os.devnull, os.O_RDONLY | os.O_CLOEXEC)
        null = self._null
        emulated = program.emulates_terminal
        if program.unit.core or (self._unattended and not emulated):
            output.direct = True
            return (null, output.log, output.log), []
        given = []
        ends = []
        output.direct = not program.screen and not emulated
        outputs: tuple[tuple[bool, bool, Callable[[str, str], None], OutputSource], ...] = (
            (
                program.screen or emulated,
                self._console.is_terminal or emulated,
                self._console.show if program.screen and not self._unattended else _ignore,
                "out",
            ),
            (True, emulated, _ignore if self._unattended else self._console.show_error, "err"),
        )
        for wanted, as_terminal, show, source in outputs:
            if not wanted:
                ends.append(output.log)
                continue
            reader, writer = _open_pseudo_terminal() if as_terminal else os.pipe2(os.O_CLOEXEC)
            reported = show if output.direct else self._tee(show, source)
            stream = Stream(name, reader, output.log, reported)
            output.streams.append(stream)
            self._streams[reader] = stream
            self._poll.register(reader, select.POLLIN)
            given.append(writer)
            ends.append(writer)
        return (null, ends[0], ends[1]), given

    def read(self, descriptor: int) -> bool:
        """Read available output. False at the end of the stream."""
        stream = self._streams.get(descriptor)
        if stream is None:
            return False
        output = self._outputs[stream.name]
        more = stream.read(output.recent)
        if not more:
            self._close_stream(stream)
            output.streams.remove(stream)
        elif stream.may_pause:
            self._pause(descriptor)
        return more

    @property
    def due(self) -> float:
        """Return the time at which `work` is due next."""
        return min([self._rotation.due, *self._paused.values()])

    def work(self, now: float) -> None:
        """Read the streams that were deferred, and cut log files that have become too large."""
        if now >= self._rotation.due:
            removed = self._rotation.check(now)
            for output in self._outputs.values() if removed else ():
                output.read_back = max(0, output.read_back - removed.get(output.path, 0))
        for descriptor in [each for each, due in self._paused.items() if due <= now]:
            self._poll.register(descriptor, select.POLLIN)
            del self._paused[descriptor]
            self.read(descriptor)

    def drain(self, name: str) -> None:
        """Read the remaining output of a node that has ended."""
        output = self._outputs.get(name)
        for stream in list(output.streams) if output else ():
            limit = 64  # a child that continues to print must not block this loop
            while limit and select.select([stream.descriptor], [], [], 0)[0] and self.read(stream.descriptor):
                limit -= 1

    def drain_all(self) -> None:
        """Read the remaining output of every node."""
        for name in self._outputs:
            self.drain(name)

    def find_path(self, program: UnitProgram) -> str:
        """Return the log file with a node's output."""
        return f"{self._folder}/{program.log_name}-stdout.log"

    def find_last_lines(self, name: str) -> tuple[str, ...]:
        """Return the last lines that a node printed."""
        output = self._outputs.get(name)
        return () if output is None else tuple(output.recent or read_last_lines(output.path))

    def skip_back(self) -> None:
        """Read log files back only from their present end on."""
        for output in self._outputs.values():
            output.read_back = _size(output.path)
            output.splitter = LineSplitter()

    def read_back(self) -> None:
        """Show new lines of log files that nodes write directly."""
        for name, output in self._outputs.items():
            if output.direct:
                self._read_back(name, output)

    def close(self) -> None:
        """Close every descriptor."""
        for output in self._outputs.values():
            self._close(output)
        if self._null >= 0:
            os.close(self._null)
            self._null = -1

    def _tee(self, show: Callable[[str, str], None], source: OutputSource) -> Callable[[str, str], None]:
        def report(name: str, line: str) -> None:
            show(name, line)
            self._report(name, source, line)

        return report

    def _read_back(self, name: str, output: _Output) -> None:
        size = _size(output.path)
        if size < output.read_back:
            output.read_back = 0
        if size == output.read_back:
            return
        output.splitter = output.splitter or LineSplitter()
        try:
            with open(output.path, "rb") as file:  # noqa: PTH123 - pathlib is not worth its import here
                if size - output.read_back > MOST_TAIL:
                    output.read_back = size - MOST_TAIL
                    output.splitter = LineSplitter()
                    self._report(name, "log", "... lines are not shown here; the log file has them")
                file.seek(output.read_back)
                data = file.read(MOST_TAIL)
        except OSError:
            return
        output.read_back += len(data)
        for line in output.splitter.feed(data):
            self._report(name, "log", make_printable(line))

    def _pause(self, descriptor: int) -> None:
        if descriptor not in self._paused:
            self._poll.unregister(descriptor)
        self._paused[descriptor] = time.monotonic() + FLOOD_PAUSE

    def _close_stream(self, stream: Stream) -> None:
        if self._paused.pop(stream.descriptor, None) is None:
            self._poll.unregister(stream.descriptor)
        self._streams.pop(stream.descriptor, None)
        stream.close()

    def _close(self, output: _Output) -> None:
        for stream in output.streams:
            self._close_stream(stream)
        output.streams.clear()
        os.close(output.log)


def _ignore(name: str, line: str) -> None:
    """Show nothing: the log has the line."""


def _size(path: str) -> int:
    try:
        return os.stat(path).st_size  # noqa: PTH116 - pathlib is not worth its import here
    except OSError:
        return 0


def _open_log(path: str, *, fresh: bool) -> int:
    flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC | (os.O_TRUNC if fresh else 0)
    try:
        return os.open(path, flags, 0o600)  # output of nodes may contain passwords
    except OSError:
        return os.open(os.devnull, os.O_WRONLY | os.O_CLOEXEC)


def _open_pseudo_terminal() -> tuple[int, int]:
    # Programs write line by line to a terminal; through a pipe their output would arrive in late blocks.
    import termios

    reader, writer = os.openpty()
    attributes = termios.tcgetattr(writer)
    attributes[1] &= ~termios.OPOST  # no carriage returns
    attributes[3] &= ~termios.ECHO
    termios.tcsetattr(writer, termios.TCSANOW, attributes)
    return reader, writer
