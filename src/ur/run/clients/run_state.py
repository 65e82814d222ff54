"""The state of a run and its nodes, derived from its events, for every client. Pure."""

import re
import signal
from collections.abc import Sequence
from typing import Literal

from ur.run.clients.protocol import (
    LinkChanged,
    NodeChanged,
    NodeReadiness,
    OutputLine,
    RunEnded,
    RunEvent,
    RunStarted,
    RunStopping,
    StatsSampled,
    Synchronised,
)
from ur.run.output.messages import describe_link, describe_status
from ur.run.supervisor.state import ExitStatus
from ur.source.data_classes import dataclass, replace

Mood = Literal["up", "busy", "idle", "failed"]
STANDING: tuple[Mood, ...] = ("up", "busy", "failed", "idle")  # the order in which moods are counted

_END_REQUESTS = (signal.SIGINT, signal.SIGTERM)  # what a run sends to nodes that have to end

# Lines that RViz prints on every healthy start: they stay in the log, and are no news of the node.
_NOISE = re.compile(
    r"\[rospack\] Error: no such package media_export|\[librospack\]: error while executing command"
    r"|QStandardPaths: XDG_RUNTIME_DIR not set"
    r"|rviz/glsl120/indexed_8bit_image|GLSL link result|active samplers with a different type refer"
)


@dataclass(frozen=True, slots=True)
class NodeRow:
    """A node. `cpu` in cores, `memory` in bytes; None: not measured, or not running."""

    changed: NodeChanged
    ready: bool = False
    missing: tuple[str, ...] = ()
    cpu: float | None = None
    memory: int | None = None
    last: str = ""
    asked: bool = False  # to end, and has ended by that

    @property
    def name(self) -> str:
        """The node's full name."""
        return self.changed.name

    @property
    def mood(self) -> Mood:
        """The state in one word, for colours."""
        now = self.changed
        if now.state == "running":
            return "up" if self.ready or now.core else "busy"
        if now.state in ("starting", "stopping"):
            return "busy"
        died = now.signal is not None or now.exit_code not in (None, 0) or (now.reason and not now.held)
        if died and not now.held and not self.asked:
            return "failed"
        return "busy" if now.state == "waiting" and now.restart_in is not None else "idle"

    @property
    def word(self) -> str:
        """Return its state in a word or two: `up`, `not ready`, `exit 3`, `SIGSEGV`, `again in 4 s`."""
        now = self.changed
        if now.state == "running":
            return "up" if self.ready or now.core else "not ready"
        if now.state in ("starting", "stopping"):
            return now.state
        ended = describe_end(now)
        if now.state == "waiting":
            again = "waiting" if now.restart_in is None else f"again in {now.restart_in:.0f} s"
            return f"{ended}, {again}" if ended and now.restart_in is not None else again
        if now.held or self.asked:
            return "stopped"
        return ended or "not started"

    @property
    def remark(self) -> str:
        """Return the remark of the row: missing conditions, the reason for a failed start, else its last output."""
        if self.changed.reason and not self.changed.held:
            return self.changed.reason
        if self.changed.state == "running" and self.missing and not self.changed.core:
            return ", ".join(self.missing)
        return self.last


@dataclass(frozen=True, slots=True)
class RunState:
    """The whole run. `cause` is the reason of its end, None before; `exit_code` is set when it has ended.

    `lost` is the newest state of the connection to the robot while it is lost. `known`: all nodes have been described.
    """

    run: RunStarted
    rows: tuple[NodeRow, ...] = ()
    cause: str | None = None
    exit_code: int | None = None
    lost: LinkChanged | None = None
    known: bool = False

    @property
    def link(self) -> str:
        """Describe the problem of the connection to the robot, '' while there is none."""
        return describe_link(self.lost.robot, self.lost.seconds, lost=True) if self.lost is not None else ""

    def find(self, name: str) -> NodeRow | None:
        """Return the row of a node, or None."""
        return next((row for row in self.rows if row.name == name), None)

    def count(self) -> dict[Mood, int]:
        """Return the number of nodes in each mood, without the master and rosout."""
        counts: dict[Mood, int] = dict.fromkeys(STANDING, 0)
        for row in self.rows:
            if not row.changed.core:
                counts[row.mood] += 1
        return counts


def begin_state() -> RunState:
    """Return the state before the first event."""
    return RunState(RunStarted("", 0, "", "", "", 0.0))


def apply_events(state: RunState, events: Sequence[RunEvent]) -> RunState:
    """Return the state after these events, in order. The time is proportional to events plus nodes."""
    rows = {row.name: row for row in state.rows}
    last: dict[str, str] = {}
    for event in events:
        match event:
            case OutputLine(name=name, text=text) if not _NOISE.search(text):
                last[name] = text
            case NodeChanged():
                rows[event.name] = _change(rows.get(event.name), event)
            case NodeReadiness(name, ready, missing) if name in rows:
                rows[name] = replace(rows[name], ready=ready, missing=missing)
            case StatsSampled(nodes):
                used = {each.name: each for each in nodes}
                for name, row in rows.items():
                    found = used.get(name)
                    rows[name] = replace(row, cpu=found.cpu if found else None, memory=found.memory if found else None)
            case _:
                state = _change_run(state, event)
    for name, text in last.items():
        if name in rows:
            rows[name] = replace(rows[name], last=text)
    ordered = sorted(rows.values(), key=lambda row: row.changed.core)  # stable: the launch file's order
    return replace(state, rows=tuple(ordered))


def _change_run(state: RunState, event: RunEvent) -> RunState:
    match event:
        case RunStarted():
            return replace(state, run=event)
        case RunStopping(cause):
            return replace(state, cause=cause)
        case RunEnded(code):
            return replace(state, exit_code=code)
        case LinkChanged():
            return replace(state, lost=event if event.lost else None)
        case Synchronised():
            return replace(state, known=True)
    return state


def describe_end(changed: NodeChanged) -> str:
    """Describe the last end of a node: `SIGSEGV`, `exit 3`, `finished`; '' if it never ran."""
    if changed.signal is not None:
        try:
            return signal.Signals(changed.signal).name
        except ValueError:
            return f"signal {changed.signal}"
    if changed.exit_code is None:
        return ""
    return "finished" if changed.exit_code == 0 else f"exit {changed.exit_code}"


def list_missing(state: RunState) -> dict[str, tuple[str, ...]]:
    """List the nodes that are not ready, each with its unmet conditions.

    A program that has ended successfully is no longer waited for.
    """
    missing = {}
    for row in state.rows:
        node = row.changed
        if node.core or row.ready or (node.state == "ended" and node.exit_code == 0):
            continue
        if node.state == "running":
            missing[row.name] = row.missing or ("it is not looked at yet",)
        else:
            log = f" (log: {node.log})" if node.log else ""
            missing[row.name] = (f"it does not run: {describe_node(node)}{log}",)
    return missing


def describe_node(node: NodeChanged) -> str:
    """Describe the state of a node briefly."""
    if node.pid is not None:
        text = f"{node.state}, process {node.pid}"
    elif node.state == "waiting" and node.restart_in is not None:
        text = f"starts again in {node.restart_in:.0f} s"
    elif node.held:
        text = "stopped by hand"
    elif node.signal is not None or node.exit_code is not None:
        text = describe_status(ExitStatus(node.exit_code, node.signal))
        text = f"{node.state}, {text}"
    else:
        text = node.state
    text += f", restarted {node.restarts} times" if node.restarts else ""
    return f"{text}: {node.reason}" if node.reason else text


def _change(before: NodeRow | None, now: NodeChanged) -> NodeRow:
    if before is None:
        return NodeRow(now)
    if now.state == "running" and before.changed.pid == now.pid:
        return replace(before, changed=now)
    running = now.state in ("running", "stopping")
    ended_as_asked = now.signal in _END_REQUESTS or now.exit_code in {128 + number for number in _END_REQUESTS}
    return replace(
        before,
        changed=now,
        asked=before.changed.state == "stopping" and now.state == "ended" and ended_as_asked,
        ready=False,
        missing=(),
        cpu=before.cpu if running else None,
        memory=before.memory if running else None,
    )
