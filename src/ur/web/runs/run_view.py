"""Runs as the page shows them, derived from the events of the run protocol. Pure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from ur.run.clients.protocol import (
    LinkChanged,
    NodeChanged,
    NodeReadiness,
    RunEvent,
    RunStopping,
    StatsSampled,
    Synchronised,
)
from ur.run.record.ended import EndedRun
from ur.run.record.entry import RunEntry

MOST_ENDED = 5
"""Runs that have ended, of which the page shows so many."""

_LAST_LINES = 12


@dataclass(frozen=True, slots=True)
class ShownNode:
    """A node: its last change, its readiness, and its use of processor (cores) and memory (bytes); None if unknown."""

    changed: NodeChanged
    ready: bool = False
    missing: tuple[str, ...] = ()
    cpu: float | None = None
    memory: int | None = None


@dataclass(frozen=True, slots=True)
class RunView:
    """An active run.

    `stopping` is the reason why it ends, None while it continues; `lost` is the time (s) without the robot. `known`:
    all its nodes have been described.
    """

    entry: RunEntry
    nodes: Mapping[str, ShownNode]
    stopping: str | None = None
    lost: float | None = None
    known: bool = False


def begin_view(entry: RunEntry) -> RunView:
    """Return the view of a run without any information yet."""
    return RunView(entry, {})


def take_event(view: RunView, event: RunEvent) -> RunView:
    """Return the view after an event; the same value if the event changes nothing in it."""
    match event:
        case NodeChanged():
            before = view.nodes.get(event.name, ShownNode(event))
            same = before.changed.pid == event.pid and event.pid is not None
            after = replace(before, changed=event) if same else ShownNode(event)
            return replace(view, nodes={**view.nodes, event.name: after})
        case NodeReadiness(name=name) if name in view.nodes:
            after = replace(view.nodes[name], ready=event.ready, missing=event.missing)
            return replace(view, nodes={**view.nodes, name: after})
        case StatsSampled():
            used = {each.name: each for each in event.nodes}
            nodes = {
                name: replace(
                    node,
                    cpu=used[name].cpu if name in used else None,
                    memory=used[name].memory if name in used else None,
                )
                for name, node in view.nodes.items()
            }
            return replace(view, nodes=nodes)
        case LinkChanged():
            return replace(view, lost=event.seconds if event.lost else None)
        case RunStopping():
            return replace(view, stopping=event.cause)
        case Synchronised():
            return replace(view, known=True)
    return view


def describe_runs(views: Sequence[RunView], ended: Sequence[EndedRun]) -> dict[str, object]:
    """Return the runs for display: active ones, oldest first, then ended ones, latest first."""
    return {
        "t": "runs",
        "runs": [_describe_run(view) for view in views],
        "ended": [_describe_ended(each) for each in reversed(ended[-MOST_ENDED:])],
    }


def _describe_run(view: RunView) -> dict[str, object]:
    entry = view.entry
    return {
        "run": entry.run,
        "title": entry.title,
        "master": entry.master_uri,
        "started": entry.started,
        "detached": entry.detached,
        "stopping": view.stopping,
        "lost": view.lost,
        "known": view.known,
        "nodes": [_describe_node(node) for node in view.nodes.values()],
    }


def _describe_node(node: ShownNode) -> dict[str, object]:
    hidden = ("log", "program", "folder")  # paths of this computer, which a browser cannot use
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
