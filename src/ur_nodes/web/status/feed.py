"""Diagnostics and figures of the computer, sent while a page shows them."""

import os
import socket
import time
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from urllib.parse import urlsplit

from ur.web.wire.data_frames import pack_json
from ur_nodes.ports.node import Facts, Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.raw import RawMessage
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.messages.decode import BadMessageError, decode
from ur_nodes.web.messages.definition import BadDefinitionError, read_definition
from ur_nodes.web.status.computer import CpuTimes, describe_computer, read_times, share_used
from ur_nodes.web.status.computer_files import read_computer, read_disk
from ur_nodes.web.status.diagnostics import BOUNDS, KIND, Diagnostics

_EVERY = 2.0  # s
_TOPIC = "/diagnostics"
_LONGEST = 1 << 20  # bytes of a message
_LOGGED_EVERY = 10.0  # s


Measure = Callable[[CpuTimes, Facts], tuple[CpuTimes, Mapping[str, object]]]


def measure_computer(before: CpuTimes, facts: Facts) -> tuple[CpuTimes, Mapping[str, object]]:
    """Return the processor times of now, and the known figures of this computer."""
    texts = read_computer()
    times = read_times(texts.stat)
    found = {
        **describe_computer(texts),
        "name": socket.gethostname()[:60],
        "cpu": share_used(before, times),
        "disk": read_disk(Path.home()),
        "master": str(urlsplit(os.environ.get("ROS_MASTER_URI", "")).hostname or "")[:100],
        "link": _time_link(facts),
    }
    return times, {name: each for name, each in found.items() if each is not None}


def _time_link(facts: Facts) -> float | None:
    """Return the milliseconds that reading the run's facts takes; None while they cannot be read."""
    began = time.monotonic()
    try:
        facts.get("run_id", "")
    except Exception:  # a master may answer anything
        return None
    return round(1000 * (time.monotonic() - began), 1)


class StatusFeed:
    """Sends the status that pages show. `measure` runs on a worker and gets the processor times of the last call."""

    def __init__(self, node: Node, send: Callable[[bytes], None], measure: Measure = measure_computer) -> None:
        self._node, self._send, self._measure = node, send, measure
        self._every = Every(_EVERY)
        self._measuring = False
        self._subscription: Subscription | None = None
        self._diagnostics = Diagnostics()
        self._pages: frozenset[int] = frozenset()
        self._times = CpuTimes()

    def step(self, pages: Collection[int]) -> None:
        """Send the state to these pages; to be called often."""
        if pages and self._subscription is None:
            self._subscription = self._node.raw.subscribe(_TOPIC, self._take, Quality.EVERY)
        elif not pages and self._subscription is not None:
            self._subscription.close()
            self._subscription, self._diagnostics, self._times = None, Diagnostics(), CpuTimes()
        if set(pages) - self._pages:
            self._every.hurry()
        self._pages = frozenset(pages)
        if pages and not self._measuring and self._every.due(self._node.steady()):
            self._measuring = True
            before, facts = self._times, self._node.facts
            self._node.work(lambda: self._measure(before, facts), self._pass_on, "status")

    def _pass_on(self, found: tuple[CpuTimes, Mapping[str, object]]) -> None:
        self._measuring = False
        self._times, computer = found
        components = self._diagnostics.describe(self._node.steady())
        for page in self._pages:
            self._send(pack_json(page, "status", {"t": "status", "components": components, "computer": computer}))

    def _take(self, message: RawMessage) -> None:
        if message.type_name != KIND or len(message.data) > _LONGEST:
            return
        try:
            found = decode(read_definition(KIND, message.schema), message.data, BOUNDS)
        except (BadDefinitionError, BadMessageError) as problem:
            self._node.log.warn(f"{_TOPIC}: {problem}", every=_LOGGED_EVERY)
            return
        self._diagnostics.receive(found, self._node.steady())
