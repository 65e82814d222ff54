"""Readiness of nodes: registration with the master, and the conditions of their `ready:` comments."""

import math
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress

from ur.launchfile.plan.specs import ReadyCondition
from ur.run.middleware.protocol import TF_TOPICS, GraphView, NoGraph, ReceivedMessages, RunGraph

PERIOD = 0.1  # s between two checks while a condition is unmet
STALE = 2.0  # s without a message after which a topic counts as silent

Report = Callable[[str, int, tuple[str, ...]], None]
_LOOKS, _LOOK = 20, 0.1  # a new view of ROS 2 knows its nodes only after a while; s between two


def find_missing(
    node: str,
    conditions: Sequence[ReadyCondition],
    graph: RunGraph,
    received: Mapping[str, ReceivedMessages],
    now: float,
) -> tuple[str, ...]:
    """List a running node's unmet readiness conditions, as text for the user; empty when it is ready."""
    if not any(condition.kind == "process" for condition in conditions) and not graph.knows(node):
        return ("it runs, but is not registered yet",)
    found = (_describe_unmet(condition, graph, received, now) for condition in conditions)
    return tuple(unmet for unmet in found if unmet)


def measure_rate(times: Sequence[float], rate: float, now: float) -> float | None:
    """Return messages per s over the last half second at the expected rate, three messages at least; None: too few."""
    count = max(3, math.ceil(rate / 2))
    if len(times) <= count or now - times[-1] > max(STALE, 2.0 / rate):
        return None
    return count / max(times[-1] - times[-1 - count], 1e-6)


def _describe_unmet(
    condition: ReadyCondition, graph: RunGraph, received: Mapping[str, ReceivedMessages], now: float
) -> str:
    name = condition.name
    match condition.kind:
        case "topic":
            return _describe_topic(name, condition.rate, graph, received, now)
        case "service":
            return "" if name in graph.services else f"service {name} is not offered"
        case "action":
            served = f"{name}/goal" in graph.subscribers and f"{name}/status" in graph.publishers
            return "" if served else f"action {name} has no server"
        case "frame":
            frames = set().union(*(received[topic].frames for topic in TF_TOPICS if topic in received))
            there = ", ".join(sorted(frames)) or "none at all"
            return "" if name in frames else f"tf frame {name} is not there, only: {there}"
    return ""


def _describe_topic(
    name: str, rate: float | None, graph: RunGraph, received: Mapping[str, ReceivedMessages], now: float
) -> str:
    if name not in graph.publishers:
        return f"topic {name} is not published"
    if rate is None:
        return ""
    times = received[name].times if name in received else ()
    if not times:
        return f"topic {name} is published by {', '.join(graph.publishers[name])}, but no message has come"
    measured = measure_rate(tuple(times), rate, now)
    if measured is not None and measured >= 0.9 * rate:
        return ""
    how = f"{len(times)} messages so far" if measured is None else f"{measured:.1f} Hz"
    return f"topic {name} comes too slowly: {how}, expected {rate:g} Hz"


def check_clock(
    make_view: Callable[[], GraphView], over: threading.Event, report: Callable[[str], None], patience: float = 5.0
) -> None:
    """Report in one line if no node publishes the simulated time after `patience` seconds, unless the run is over."""
    if over.wait(patience):
        return
    view = make_view()
    with suppress(NoGraph):  # which is reported by itself
        for _ in range(_LOOKS):
            if view.look(()).publishers.get("/clock") or over.wait(_LOOK):
                break
        else:
            report(
                f"no node has published /clock for {patience:g} s, and /use_sim_time is true: nodes wait until a "
                "simulator or 'rosbag play --clock FILE' does; for the time of this computer, remove /use_sim_time"
            )
    view.forget()


class ReadinessProbe:
    """Checks in a separate thread until every node is ready; calls `report(name, pid, missing)` on changes."""

    def __init__(
        self, make_view: Callable[[], GraphView], conditions: Mapping[str, Sequence[ReadyCondition]], report: Report
    ) -> None:
        self._make_view = make_view
        self._conditions = conditions
        self._notify = report
        self._running: dict[str, int] = {}
        self._reported: dict[tuple[str, int], tuple[str, ...]] = {}
        self._changed = threading.Event()
        self._over = False
        self._thread = threading.Thread(target=self._check_nodes, daemon=True)
        self._thread.start()

    def follow(self, running: Mapping[str, int]) -> None:
        """Set the running nodes, with their process ids."""
        self._running = dict(running)
        self._changed.set()

    def close(self) -> None:
        """Stop checking; the thread ends by itself."""
        self._over = True
        self._changed.set()

    def _check_nodes(self) -> None:
        view = self._make_view()
        try:
            while not self._over:
                open_ = {name: pid for name, pid in self._running.items() if self._reported.get((name, pid)) != ()}
                self._changed.clear()
                if open_:
                    self._look(view, open_)
                    view.wait(PERIOD)
                else:
                    view.forget()
                    self._changed.wait()
        finally:
            view.forget()

    def _look(self, view: GraphView, open_: Mapping[str, int]) -> None:
        try:
            graph = view.look({topic for name in open_ for topic in self._topics(name)})
        except NoGraph as problem:
            for name, pid in open_.items():
                self._report(name, pid, (str(problem),))
            return
        for name, pid in open_.items():
            conditions = self._conditions.get(name, ())
            self._report(name, pid, find_missing(name, conditions, graph, view.received, time.monotonic()))

    def _report(self, name: str, pid: int, missing: tuple[str, ...]) -> None:
        if self._reported.get((name, pid)) != missing:
            self._reported[name, pid] = missing
            self._notify(name, pid, missing)

    def _topics(self, name: str) -> set[str]:
        found: set[str] = set()
        for condition in self._conditions.get(name, ()):
            if condition.kind == "frame":
                found.update(TF_TOPICS)
            elif condition.kind == "topic" and condition.rate is not None:
                found.add(condition.name)
        return found
