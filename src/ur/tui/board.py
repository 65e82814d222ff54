"""How the nodes of a run stand, put together from its events: what the table shows. Pure."""

from __future__ import annotations

import signal
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Literal

from ur.run.events import (
    NodeChanged,
    NodeReadiness,
    OutputLine,
    RunEnded,
    RunEvent,
    RunStarted,
    RunStopping,
    StatsSampled,
)

Mood = Literal["up", "busy", "idle", "failed"]
STANDING: tuple[Mood, ...] = ("up", "busy", "failed", "idle")  # the order in which moods are counted


@dataclass(frozen=True, slots=True)
class NodeRow:
    """A node as the table shows it. `cpu` in cores, `memory` in bytes; None: not measured, or it does not run."""

    changed: NodeChanged
    ready: bool = False
    missing: tuple[str, ...] = ()
    cpu: float | None = None
    memory: int | None = None
    last: str = ""

    @property
    def name(self) -> str:
        """The node's full name."""
        return self.changed.name

    @property
    def mood(self) -> Mood:
        """How it is, in one word for colours."""
        now = self.changed
        if now.state == "running":
            return "up" if self.ready or now.core else "busy"
        if now.state in ("starting", "stopping"):
            return "busy"
        died = now.signal is not None or now.exit_code not in (None, 0) or (now.reason and not now.held)
        if died and not now.held:
            return "failed"
        return "busy" if now.state == "waiting" and now.restart_in is not None else "idle"

    @property
    def word(self) -> str:
        """Its state in a word or two: `up`, `registering`, `exit 3`, `SIGSEGV`, `again in 4 s`."""
        now = self.changed
        if now.state == "running":
            return "up" if self.ready or now.core else "coming up"
        if now.state in ("starting", "stopping"):
            return now.state
        ended = describe_end(now)
        if now.state == "waiting":
            again = "waiting" if now.restart_in is None else f"again in {now.restart_in:.0f} s"
            return f"{ended}, {again}" if ended and now.restart_in is not None else again
        if now.held:
            return "stopped"
        return ended or "not started"

    @property
    def remark(self) -> str:
        """What else people should know: what is missing, why it was not started, else what it printed last."""
        if self.changed.reason and not self.changed.held:
            return self.changed.reason
        if self.changed.state == "running" and self.missing and not self.changed.core:
            return ", ".join(self.missing)
        return self.last


@dataclass(frozen=True, slots=True)
class Board:
    """The whole run. `cause` says why it ends, None while it goes on; `exit_code` is set once it has ended."""

    run: RunStarted
    rows: tuple[NodeRow, ...] = ()
    cause: str | None = None
    exit_code: int | None = None

    def find(self, name: str) -> NodeRow | None:
        """The row of a node."""
        return next((row for row in self.rows if row.name == name), None)

    def count(self) -> dict[Mood, int]:
        """How many nodes are in each mood; the master and rosout do not count."""
        counts: dict[Mood, int] = dict.fromkeys(STANDING, 0)
        for row in self.rows:
            if not row.changed.core:
                counts[row.mood] += 1
        return counts


def begin_board() -> Board:
    """Before anything was told."""
    return Board(RunStarted("", 0, "", "", "", 0.0))


def apply_events(board: Board, events: Iterable[RunEvent]) -> Board:
    """The board after these events, in their order. Costs time in proportion to events plus nodes."""
    rows = {row.name: row for row in board.rows}
    run, cause, exit_code = board.run, board.cause, board.exit_code
    last: dict[str, str] = {}
    for event in events:
        match event:
            case OutputLine(name=name, text=text):
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
            case RunStarted():
                run = event
            case RunStopping(why):
                cause = why
            case RunEnded(code):
                exit_code = code
            case _:
                pass
    for name, text in last.items():
        if name in rows:
            rows[name] = replace(rows[name], last=text)
    ordered = sorted(rows.values(), key=lambda row: row.changed.core)  # stable: the launch file's order
    return Board(run, tuple(ordered), cause, exit_code)


def describe_end(changed: NodeChanged) -> str:
    """How a node ended last: `SIGSEGV`, `exit 3`, `finished`; '' when it never ran."""
    if changed.signal is not None:
        try:
            return signal.Signals(changed.signal).name
        except ValueError:
            return f"signal {changed.signal}"
    if changed.exit_code is None:
        return ""
    return "finished" if changed.exit_code == 0 else f"exit {changed.exit_code}"


def _change(before: NodeRow | None, now: NodeChanged) -> NodeRow:
    if before is None:
        return NodeRow(now)
    if now.state == "running" and before.changed.pid == now.pid:
        return replace(before, changed=now)
    running = now.state in ("running", "stopping")
    return replace(
        before,
        changed=now,
        ready=False,
        missing=(),
        cpu=before.cpu if running else None,
        memory=before.memory if running else None,
    )
