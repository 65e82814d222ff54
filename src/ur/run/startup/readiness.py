"""Readiness of nodes: registered with the master, and with what their `ready:` comments require."""

from __future__ import annotations

import math
import select
import threading
import time
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field

from ur.launchfile.plan.specs import ReadyCondition
from ur.run.master.client import CALLER, Master
from ur.run.master.tcpros import NoTopic, TopicConnection, listen_to, read_frames
from ur.run.master.xml_rpc import CallRefused, Unanswered

PERIOD = 0.1  # s between two looks while something is missing
TIMEOUT = 1.0  # s that a publisher gets to answer
STALE = 2.0  # s without a message after which a topic does not come any more
TF_TOPICS = ("/tf", "/tf_static")

Report = Callable[[str, int, tuple[str, ...]], None]


@dataclass(frozen=True, slots=True)
class MasterGraph:
    """The master's nodes by topic and service: publishers, subscribers, and servers."""

    publishers: Mapping[str, Sequence[str]]
    subscribers: Mapping[str, Sequence[str]]
    services: Mapping[str, Sequence[str]]

    def knows(self, node: str) -> bool:
        """Test for a registered node."""
        return any(
            node in nodes for kind in (self.publishers, self.subscribers, self.services) for nodes in kind.values()
        )


@dataclass(slots=True)
class ReceivedMessages:
    """Messages received on a topic: their times (any clock, s), and frames where it is one of tf."""

    times: deque[float] = field(default_factory=lambda: deque(maxlen=1000))
    frames: set[str] = field(default_factory=set)


def find_missing(
    node: str,
    conditions: Sequence[ReadyCondition],
    graph: MasterGraph,
    received: Mapping[str, ReceivedMessages],
    now: float,
) -> tuple[str, ...]:
    """List a running node's unmet readiness conditions, as text for people; empty when it is ready."""
    if not any(condition.kind == "process" for condition in conditions) and not graph.knows(node):
        return ("it runs, but is not registered with the master",)
    found = (_describe_unmet(condition, graph, received, now) for condition in conditions)
    return tuple(unmet for unmet in found if unmet)


def measure_rate(times: Sequence[float], rate: float, now: float) -> float | None:
    """Messages per s over the last half second at the expected rate, three messages at least; None: too few so far."""
    count = max(3, math.ceil(rate / 2))
    if len(times) <= count or now - times[-1] > max(STALE, 2.0 / rate):
        return None
    return count / max(times[-1] - times[-1 - count], 1e-6)


def _describe_unmet(
    condition: ReadyCondition, graph: MasterGraph, received: Mapping[str, ReceivedMessages], now: float
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
    name: str, rate: float | None, graph: MasterGraph, received: Mapping[str, ReceivedMessages], now: float
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


class ReadinessProbe:
    """Checks, in a thread of its own, until every node is ready; calls `report(name, pid, missing)` on changes."""

    def __init__(self, master: Master, conditions: Mapping[str, Sequence[ReadyCondition]], report: Report) -> None:
        self._master = master
        self._conditions = conditions
        self._notify = report
        self._running: dict[str, int] = {}
        self._reported: dict[tuple[str, int], tuple[str, ...]] = {}
        self._changed = threading.Event()
        self._over = False
        self._listeners: dict[tuple[str, str], TopicConnection] = {}
        self._received: dict[str, ReceivedMessages] = {}
        self._thread = threading.Thread(target=self._check_nodes, daemon=True)
        self._thread.start()

    def follow(self, running: Mapping[str, int]) -> None:
        """These nodes run now, with these process ids."""
        self._running = dict(running)
        self._changed.set()

    def close(self) -> None:
        """Stop checking; the thread ends by itself."""
        self._over = True
        self._changed.set()

    def _check_nodes(self) -> None:
        while not self._over:
            open_ = {name: pid for name, pid in self._running.items() if self._reported.get((name, pid)) != ()}
            self._changed.clear()
            if open_:
                self._look(open_)
            if not open_ or not self._listeners:
                self._forget_listeners()
                self._changed.wait(PERIOD if open_ else None)
            else:
                self._listen(PERIOD)
        self._forget_listeners()

    def _look(self, open_: Mapping[str, int]) -> None:
        try:
            publishers, subscribers, services = (dict(kind) for kind in self._master.get_system_state())
        except (Unanswered, CallRefused, ValueError, TypeError) as problem:
            for name, pid in open_.items():
                self._report(name, pid, (f"the master does not answer: {problem}",))
            return
        graph = MasterGraph(publishers, subscribers, services)
        self._connect({topic for name in open_ for topic in self._topics(name)}, graph)
        for name, pid in open_.items():
            self._report(
                name, pid, find_missing(name, self._conditions.get(name, ()), graph, self._received, time.monotonic())
            )

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

    def _connect(self, topics: set[str], graph: MasterGraph) -> None:
        for topic in topics:
            for node in graph.publishers.get(topic, ()):
                if (topic, node) in self._listeners:
                    continue
                with suppress(NoTopic, Unanswered, CallRefused):  # it is asked again at the next look
                    uri = self._master.call("lookupNode", node)
                    keep = 1 << 20 if topic in TF_TOPICS else 0
                    listener = listen_to(uri, topic, keep=keep, timeout=TIMEOUT, caller=CALLER)
                    self._listeners[topic, node] = listener
                    self._received.setdefault(topic, ReceivedMessages())

    def _listen(self, period: float) -> None:
        end = time.monotonic() + period
        while self._listeners and (left := end - time.monotonic()) > 0:
            keys = {listener.fileno(): key for key, listener in self._listeners.items()}
            for descriptor in select.select(list(keys), [], [], left)[0]:
                key = keys[descriptor]
                received = self._received[key[0]]
                try:
                    messages = self._listeners[key].receive()
                except NoTopic:
                    self._listeners.pop(key).close()
                    continue
                received.times.extend([time.monotonic()] * len(messages))
                if key[0] in TF_TOPICS:
                    received.frames.update(*(read_frames(message) for message in messages))

    def _forget_listeners(self) -> None:
        for listener in self._listeners.values():
            listener.close()
        self._listeners.clear()
        self._received.clear()
