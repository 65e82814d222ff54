"""Events about the state of a run, and its subscribers over a socket or an open file; none delays the run."""

from __future__ import annotations

import os
import select
import socket
from collections.abc import Callable, Iterable, Iterator, Mapping

from ur.run.clients.protocol import (
    BadLineError,
    LinkChanged,
    NodeChanged,
    NodeReadiness,
    NodeState,
    NodeStats,
    Notice,
    OutputLine,
    OutputSource,
    RunCommand,
    RunEnded,
    RunEvent,
    RunStarted,
    RunStopping,
    Severity,
    StatsSampled,
    Synchronised,
    Watch,
    dump_line,
    find_severity,
    parse_command,
)
from ur.run.output.console import Sink
from ur.run.supervisor.state import RunPhase, State, UnitState, UnitStatus
from ur.source.data_classes import dataclass, replace

MOST_COMMAND_BYTES = 64 * 1024
MOST_BACKLOG = 20_000  # events; a client that does not read for so long is disconnected


class Subscribers:
    """All subscribers. `descriptors` are for polling; `attend` handles an event on one of them."""

    def __init__(self, listener: socket.socket | None, describe_state: Callable[[], Iterable[RunEvent]]) -> None:
        """Take a listening socket, and a source of the events that describe the current state to a new subscriber."""
        self._listener = listener
        self._describe_state = describe_state
        self._subscribers: dict[int, _Subscriber] = {}
        self.on_removed: Callable[[int], None] | None = None  # before a descriptor is closed

    def add_socket(self, link: socket.socket) -> int:
        """Add a client that may also send commands; return its descriptor, which identifies it."""
        link.setblocking(False)
        return self._add(_Subscriber(link.fileno(), link, Watch()))

    def add_output(self, descriptor: int, watch: Watch) -> int:
        """Add an open file that events are written to, and that is never read; return its descriptor."""
        return self._add(_Subscriber(descriptor, None, watch))

    def descriptors(self) -> dict[int, int]:
        """Poll event masks by descriptor."""
        found = {} if self._listener is None else {self._listener.fileno(): select.POLLIN}
        for descriptor, subscriber in self._subscribers.items():
            wanted = (select.POLLIN if subscriber.link is not None else 0) | (
                select.POLLOUT if subscriber.sink.waiting else 0
            )
            if wanted:
                found[descriptor] = wanted
        return found

    def holds(self, descriptor: int) -> bool:
        """Test for a descriptor of a connected subscriber."""
        return descriptor in self._subscribers

    def wanted(self) -> Watch:
        """The union of all subscribers' subscriptions."""
        watches = [subscriber.watch for subscriber in self._subscribers.values()]
        return Watch(
            output=any(watch.output for watch in watches),
            stats=any(watch.stats for watch in watches),
            readiness=any(watch.readiness for watch in watches),
        )

    def publish(self, event: RunEvent) -> None:
        """Send an event to the subscribers that asked for its kind."""
        if not self._subscribers:
            return
        line = b""
        for descriptor, subscriber in list(self._subscribers.items()):
            if not subscriber.wants(event):
                continue
            line = line or dump_line(event)
            source = event.name if isinstance(event, OutputLine) else ""
            subscriber.sink.put(line, important=not isinstance(event, (OutputLine, StatsSampled)), source=source)
            if subscriber.sink.backlog > MOST_BACKLOG:
                self._drop(descriptor)

    def attend(self, descriptor: int) -> list[RunCommand]:
        """Accept, read and write without blocking; return the received commands."""
        if self._listener is not None and descriptor == self._listener.fileno():
            try:
                self.add_socket(self._listener.accept()[0])
            except OSError:
                return []
            return []
        subscriber = self._subscribers.get(descriptor)
        if subscriber is None:
            return []
        subscriber.sink.flush()
        commands, open_ = subscriber.read()
        if not open_:
            self._drop(descriptor)
        asked: list[RunCommand] = []
        for command in commands:
            if isinstance(command, Watch):
                subscriber.watch = command
            else:
                asked.append(command)
        return asked

    def flush(self) -> None:
        """Write pending data without blocking."""
        for subscriber in self._subscribers.values():
            subscriber.sink.flush()

    def close(self, limit: float) -> None:
        """Write the pending data within a time limit (s) for each subscriber, and disconnect all."""
        for descriptor, subscriber in list(self._subscribers.items()):
            subscriber.sink.finish(limit)
            self._drop(descriptor)
        if self._listener is not None:
            self._listener.close()
            self._listener = None

    def _add(self, subscriber: _Subscriber) -> int:
        self._subscribers[subscriber.descriptor] = subscriber
        for event in (*self._describe_state(), Synchronised()):
            subscriber.sink.put(dump_line(event), important=True)
        return subscriber.descriptor

    def _drop(self, descriptor: int) -> None:
        subscriber = self._subscribers.pop(descriptor)
        if self.on_removed is not None:
            self.on_removed(descriptor)
        if subscriber.link is not None:
            subscriber.link.close()


class _Subscriber:
    def __init__(self, descriptor: int, link: socket.socket | None, watch: Watch) -> None:
        self.descriptor = descriptor
        self.link = link
        self.watch = watch
        self.sink = Sink(descriptor, _describe_lost)
        self._rest = b""

    def wants(self, event: RunEvent) -> bool:
        if isinstance(event, OutputLine):
            return self.watch.output
        return self.watch.stats if isinstance(event, StatsSampled) else True

    def read(self) -> tuple[list[RunCommand], bool]:
        """Return the received commands, and whether the client is still connected."""
        if self.link is None:
            return [], True
        try:
            data = os.read(self.descriptor, 1 << 16)
        except BlockingIOError:
            return [], True
        except OSError:
            return [], False
        *lines, self._rest = (self._rest + data).split(b"\n")
        commands = []
        for line in lines:
            try:
                commands.append(parse_command(line))
            except BadLineError as problem:  # noqa: PERF203 - the other subscribers go on
                self.sink.put(dump_line(Notice("error", f"not a command: {problem}")), important=True)
        return commands, bool(data) and len(self._rest) < MOST_COMMAND_BYTES


def _describe_lost(count: int) -> bytes:
    return dump_line(Notice("warning", f"{count} lines are not shown here; the log files have them"))


_TICK = os.sysconf("SC_CLK_TCK")
_PAGE = os.sysconf("SC_PAGE_SIZE")


@dataclass(frozen=True, slots=True)
class Usage:
    """Usage of a process and its descendants: `cpu` in s since they started, `memory` (resident) in bytes."""

    cpu: float
    memory: int


def read_usage(pids: Mapping[str, int]) -> dict[str, Usage]:
    """Return the usage of each process tree, by the name of its root. A tree that has ended is left out."""
    children: dict[int, list[int]] = {}
    own: dict[int, tuple[int, int]] = {}
    for pid, parent, ticks, pages in _read_processes():
        children.setdefault(parent, []).append(pid)
        own[pid] = (ticks, pages)
    found = {}
    for name, root in pids.items():
        if root not in own:
            continue
        ticks = pages = 0
        queue = [root]
        while queue:
            pid = queue.pop()
            ticks += own[pid][0]
            pages += own[pid][1]
            queue += children.get(pid, ())
        found[name] = Usage(ticks / _TICK, pages * _PAGE)
    return found


def _read_processes() -> Iterator[tuple[int, int, int, int]]:
    for entry in os.listdir("/proc"):  # noqa: PTH208 - pathlib is not worth its import here
        if not entry.isdigit():
            continue
        try:
            with open(f"/proc/{entry}/stat", "rb") as file:  # noqa: PTH123 - likewise
                words = file.read().rpartition(b")")[2].split()
        except OSError:
            continue
        yield int(entry), int(words[1]), int(words[11]) + int(words[12]), int(words[21])


SAMPLE_PERIOD = 1.0  # s between two samples of what nodes use
TAIL_PERIOD = 0.1  # s between two reads of log files
_NODE_STATES: dict[UnitStatus, NodeState] = {
    UnitStatus.WAITING: "waiting",
    UnitStatus.STARTING: "starting",
    UnitStatus.RUNNING: "running",
    UnitStatus.ENDED: "ended",
}


@dataclass(frozen=True, slots=True)
class NodeConstants:
    """Constant facts about a node: its log file, and its executable."""

    log: str
    program: str


class RunPublisher:
    """The subscribers of one run, and the state that they have received."""

    def __init__(
        self,
        started: RunStarted,
        listener: socket.socket | None,
        facts: Mapping[str, NodeConstants],
        read_back: Callable[[bool], None],
        state: State,
        now: float,
    ) -> None:
        """Create the publisher. `facts` are by unit name; `read_back(anew)` publishes new log lines, or starts to."""
        self._started = started
        self._facts = facts
        self._read_back = read_back
        self._state = state
        self._now = now
        self._readiness: dict[str, tuple[str, ...]] = {}
        self._link: LinkChanged | None = None  # while it is lost
        self._wanted = Watch()
        self._usage: tuple[float, dict[str, Usage]] = (0.0, {})
        self._next_sample: float | None = None
        self._next_tail: float | None = None
        self.subscribers = Subscribers(listener, self._describe)

    @property
    def wants_readiness(self) -> bool:
        """True while a subscriber asks for the readiness of nodes."""
        return self._wanted.readiness

    @property
    def due(self) -> float | None:
        """Return the time at which `work` is due next; None: only on events."""
        return min((time for time in (self._next_sample, self._next_tail) if time is not None), default=None)

    def note_state(self, state: State, now: float) -> None:
        """Publish the changes of the run's state."""
        before, self._state, self._now = self._state, state, now
        for old, new in zip(before.units, state.units, strict=True):
            if old is not new:
                name = new.unit.name
                if not new.alive or old.pid != new.pid:
                    self._readiness.pop(name, None)
                self.subscribers.publish(self._describe_unit(new))
        if before.phase is not state.phase and state.phase is RunPhase.STOPPING_NODES:
            self.subscribers.publish(RunStopping(state.cause or ""))

    def note_readiness(self, name: str, missing: tuple[str, ...]) -> None:
        """Publish a node's readiness (no unmet conditions: ready) if it has changed."""
        if self._readiness.get(name) == missing:
            return
        self._readiness[name] = missing
        self.subscribers.publish(NodeReadiness(name, not missing, missing))

    def publish_output(self, name: str, source: OutputSource, text: str) -> None:
        """Publish a line that a node printed."""
        if self._wanted.output:
            self.subscribers.publish(OutputLine(name, source, find_severity(text), text))

    def publish_notice(self, severity: Severity, text: str) -> None:
        """Publish a message of the run itself."""
        self.subscribers.publish(Notice(severity, text))

    def publish_link(self, robot: str, seconds: float, *, lost: bool) -> None:
        """Publish the state of the link to the robot."""
        news = LinkChanged(robot, lost, round(seconds, 1))
        self._link = news if lost else None
        self.subscribers.publish(news)

    def attend(self, descriptor: int, now: float) -> list[RunCommand]:
        """Handle an event on a descriptor: connect, disconnect, command, or ready for writing. Returns commands."""
        asked = self.subscribers.attend(descriptor)
        self.update_subscriptions(now)
        return asked

    def update_subscriptions(self, now: float) -> None:
        """Start and end the work that is only done for subscribers."""
        before, self._wanted = self._wanted, self.subscribers.wanted()
        if self._wanted.output != before.output:
            self._next_tail = now if self._wanted.output else None
            if self._wanted.output:
                self._read_back(True)
        if self._wanted.stats != before.stats:
            self._next_sample = now if self._wanted.stats else None
            self._usage = (now, {})

    def work(self, now: float) -> None:
        """Sample statistics and read logs back if they are due."""
        if self._next_tail is not None and now >= self._next_tail:
            self._read_back(False)
            self._next_tail = now + TAIL_PERIOD
        if self._next_sample is not None and now >= self._next_sample:
            self._sample(now)
            self._next_sample = now + SAMPLE_PERIOD

    def end(self, exit_code: int, limit: float = 1.0) -> None:
        """Publish the end and disconnect all subscribers."""
        if self._wanted.output:
            self._read_back(False)
        self.subscribers.publish(RunEnded(exit_code))
        self.subscribers.close(limit)

    def _describe(self) -> Iterable[RunEvent]:
        yield replace(self._started)
        for each in self._state.units:
            yield self._describe_unit(each)
        for name, missing in self._readiness.items():
            yield NodeReadiness(name, not missing, missing)
        if self._link is not None:
            yield self._link
        if self._state.cause is not None:
            yield RunStopping(self._state.cause)

    def _describe_unit(self, each: UnitState) -> NodeChanged:
        state = _NODE_STATES[each.status]
        facts = self._facts.get(each.unit.name, NodeConstants("", ""))
        stopping = each.alive and (each.request is not None or self._state.cause is not None)
        return NodeChanged(
            name=each.unit.name,
            state="stopping" if stopping else state,
            pid=each.pid,
            exit_code=each.exit.code if each.exit else None,
            signal=each.exit.signal if each.exit else None,
            restarts=each.restarts,
            restart_in=None if each.due is None else max(0.0, each.due - self._now),
            reason=each.reason,
            held=each.held,
            core=each.unit.core,
            required=each.unit.required,
            log=facts.log,
            program=facts.program,
        )

    def _sample(self, now: float) -> None:
        pids = {each.unit.name: each.pid for each in self._state.units if each.pid is not None}
        then, before = self._usage
        usage = read_usage(pids)
        self._usage = (now, usage)
        passed = max(now - then, 1e-3)
        self.subscribers.publish(
            StatsSampled(
                tuple(
                    NodeStats(
                        name,
                        round(max(0.0, found.cpu - before[name].cpu) / passed, 3) if name in before else 0.0,
                        found.memory,
                    )
                    for name, found in usage.items()
                )
            )
        )
