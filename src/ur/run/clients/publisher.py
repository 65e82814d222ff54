"""Events about the state of a run for its subscribers; node usage and log lines are read only while subscribed."""

import os
import socket
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from ur.run.clients.protocol import (
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
    Watch,
    find_severity,
)
from ur.run.clients.subscribers import Subscribers
from ur.run.supervisor.state import RunPhase, State, UnitState, UnitStatus

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
