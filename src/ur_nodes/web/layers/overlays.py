"""Sonars, fiducials, other robots, frontiers, the spread of the pose, subscribed to while a page shows them; bumpers.

They are found by the types and names of their topics, since each robot has others.
"""

from collections.abc import Callable, Collection, Sequence
from functools import partial

from ur.source.printable import printable
from ur.web.wire.frames import Kind, Layer, json_frame
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.web.layers.overlay_values import OVERLAYS, Place
from ur_nodes.web.layers.pacing import Every

_EVERY = 0.2  # s between two frames of a layer
_MOST = 64  # topics of a layer

Topic = tuple[str, str]


def choose_topics(layer: Layer, topics: Sequence[Topic], resolve: Callable[[str], str]) -> list[Topic]:
    """Return the topics of a layer among all topics (full name, type), at most 64; `resolve` returns full names."""
    overlay = OVERLAYS[layer]
    own = resolve(overlay.topic) if overlay.topic else ""

    def belongs(name: str, kind: str) -> bool:
        return kind in overlay.kinds and (name == own if own else overlay.belongs(name.split("/"), kind))

    return [topic for topic in sorted(topics) if belongs(*topic)][:_MOST]


class Overlays:
    """Sends the layers that pages show, and tracks bumpers. `pose_of` returns the pose of a frame in the map frame."""

    def __init__(self, node: Node, pose_of: Place, send: Callable[[bytes], None]) -> None:
        self._node, self._place, self._send = node, pose_of, send
        self._topics: Sequence[Topic] = ()
        self._stale = False  # what is wanted, or the topics, have changed
        self._wanted: frozenset[Layer] = frozenset()
        self._watched = False
        self._subscriptions: dict[tuple[Layer, str], Subscription] = {}
        self._newest: dict[tuple[Layer, str], object] = {}
        self._sent: dict[Layer, dict[str, object]] = {}
        self._send_every = Every(_EVERY)

    def want(self, layers: Collection[int], *, watched: bool) -> None:
        """Choose the layers to send; with `watched`, a page is open and bumpers are tracked."""
        wanted = frozenset(layer for layer in OVERLAYS if layer and layer in layers)
        self._stale = self._stale or (wanted, watched) != (self._wanted, self._watched)
        self._wanted, self._watched = wanted, watched

    def update_topics(self, topics: Sequence[Topic]) -> None:
        """Take the names and types of all topics."""
        self._topics, self._stale = topics, True

    def pressed(self) -> list[str]:
        """Return the names of the bumpers that are pressed."""
        names = {name for (layer, name), value in self._newest.items() if layer == Layer.NONE and value}
        return sorted(printable(name.rpartition("/")[2])[:40] for name in names)

    def step(self, now: float) -> None:
        """Subscribe to the chosen layers, and send changed ones; to be called often. `now` is `Node.steady`."""
        if self._stale:
            self._stale = False
            self._follow()
        if not self._send_every.due(now):
            return
        for layer in self._wanted:
            found = {name: value for (each, name), value in self._newest.items() if each == layer}
            self._show(layer, OVERLAYS[layer].describe(found, self._place))

    def _follow(self) -> None:
        layers = {*self._wanted, *((Layer.NONE,) if self._watched else ())}
        resolve = self._node.resolve
        wanted = {(layer, *topic) for layer in layers for topic in choose_topics(layer, self._topics, resolve)}
        for key in self._subscriptions.keys() - {(layer, name) for layer, name, _ in wanted}:
            self._subscriptions.pop(key).close()
            self._newest.pop(key, None)
        for layer, name, kind in wanted:
            key = layer, name
            if key not in self._subscriptions:
                take = partial(self._newest.__setitem__, key)
                value, quality = OVERLAYS[layer].kinds[kind]
                self._subscriptions[key] = self._node.subscribe(name, value, take, quality)
        for layer in self._sent.keys() - self._wanted:  # what a page gets that wants the layer again is old
            self._show(layer, {})
            del self._sent[layer]

    def _show(self, layer: Layer, value: dict[str, object]) -> None:
        if value != self._sent.get(layer, {}):
            self._sent[layer] = value
            self._send(json_frame(Kind.OVERLAY, value, layer))
