"""The source of the map: a topic or a service."""

from __future__ import annotations

from collections.abc import Callable

from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.scan_feed import SILENCE
from ur_nodes.ports.services import AskMap
from ur_nodes.ports.values import Map, Result

_PATIENCE = 120.0  # s: large maps take long over WiFi


class MapSource:
    """Passes on each map of the topic `map`, or that of the service `static_map` once it is available."""

    def __init__(self, node: Node, take: Callable[[Map], None], *, topic: bool) -> None:
        self._node, self._take = node, take
        self._asking = False
        if topic:
            node.subscribe("map", Map, take, Quality.LATCHED)
        else:
            self._timer = node.every(1.0, self._ask)
            self._ask()

    def _ask(self) -> None:
        if not self._asking:
            self._asking = True
            self._node.call("static_map", AskMap(), self._take_answer, _PATIENCE)

    def _take_answer(self, answer: Result) -> None:
        self._asking = False
        if isinstance(answer.value, Map):
            self._timer.cancel()
            self._take(answer.value)
        else:
            service = self._node.resolve("static_map")
            self._node.log.warn(f"no map from service {service} yet: {answer.text}", every=SILENCE)
