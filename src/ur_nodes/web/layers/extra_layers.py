"""Costmaps and the localiser's particles as layers of the map, subscribed to while a page shows them."""

from collections.abc import Callable, Collection
from dataclasses import replace
from functools import partial

from ur.web.wire.frames import Layer, points_frame
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.kept_map import KeptMap
from ur_nodes.ports.node import Node, Subscription
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, MapUpdate, Poses
from ur_nodes.web.layers.pacing import Every, Frames
from ur_nodes.web.layers.tiles import GridFrames

_EVERY = 0.5  # s between two frames of a layer
_MOST_PARTICLES = 500
_COSTMAPS = {Layer.GLOBAL: "move_base/global_costmap/costmap", Layer.LOCAL: "move_base/local_costmap/costmap"}
_LOGGED_EVERY = 10.0  # s

Place = Callable[[str], "Pose2 | None"]


class ExtraLayers:
    """Sends the layers that pages show. `pose_of` returns the pose of a frame in the map frame, None if unknown.

    `put` takes functions that make frames; they are called on a worker, in order.
    """

    def __init__(self, node: Node, pose_of: Place, put: Callable[[Frames], None]) -> None:
        self._node, self._place, self._put = node, pose_of, put
        self._wanted: frozenset[Layer] = frozenset()
        self._subscriptions: dict[Layer, list[Subscription]] = {}
        self._costmaps = {layer: KeptMap() for layer in _COSTMAPS}
        self._frames = {layer: GridFrames(layer) for layer in _COSTMAPS}  # for what is called beside the node
        self._particles: Poses | None = None
        self._changed: set[Layer] = set()
        self._send_every = Every(_EVERY)

    def want(self, layers: Collection[int]) -> None:
        """Choose the layers to send."""
        self._wanted = frozenset(layer for layer in (*_COSTMAPS, Layer.PARTICLES) if layer in layers)

    def step(self, now: float) -> None:
        """Subscribe to the chosen layers, and send changed ones; to be called often. `now` is `Node.steady`."""
        if not self._send_every.due(now):
            return
        for layer in self._subscriptions.keys() - self._wanted:
            self._drop(layer)
        for layer in self._wanted - self._subscriptions.keys():
            self._subscriptions[layer] = self._subscribe(layer)
        changed, self._changed = self._changed, set()
        for layer in changed:
            if layer == Layer.PARTICLES:
                self._send_particles()
            else:
                self._send_costmap(layer)

    def _subscribe(self, layer: Layer) -> list[Subscription]:
        if layer == Layer.PARTICLES:
            return [self._node.subscribe("particlecloud", Poses, self._on_particles, Quality.LATCHED)]
        topic, update = _COSTMAPS[layer], partial(self._on_update, layer)
        return [
            self._node.subscribe(topic, Map, partial(self._on_costmap, layer)),
            self._node.subscribe(f"{topic}_updates", MapUpdate, update, Quality.EVERY),
        ]

    def _drop(self, layer: Layer) -> None:
        """Unsubscribe from a layer, and clear it on the pages: it would be old when a page shows it again."""
        for each in self._subscriptions.pop(layer):
            each.close()
        self._changed.discard(layer)
        if layer == Layer.PARTICLES:
            self._put(lambda: [points_frame(Layer.PARTICLES, [])])
        else:
            self._costmaps[layer] = KeptMap()
            self._put(self._frames[layer].clear)

    def _send_costmap(self, layer: Layer) -> None:
        costmap = self._costmaps[layer].map
        place = self._place(costmap.frame) if costmap is not None else None
        if costmap is not None and place is not None:
            grid = costmap.grid
            grid = replace(grid, values=grid.values.copy(), origin=place.compose(grid.origin))
            self._put(lambda: self._frames[layer].show(grid))

    def _send_particles(self) -> None:
        particles = self._particles
        place = self._place(particles.frame) if particles is not None else None
        if particles is not None and place is not None and len(particles.poses):
            step = max(1, -(-len(particles.poses) // _MOST_PARTICLES))
            points = place.transform_points(particles.poses[::step, :2]).tolist()
            self._put(lambda: [points_frame(Layer.PARTICLES, points)])

    def _on_costmap(self, layer: Layer, costmap: Map) -> None:
        self._costmaps[layer].replace(costmap)
        self._changed.add(layer)

    def _on_update(self, layer: Layer, update: MapUpdate) -> None:
        if problem := self._costmaps[layer].apply(update):
            self._node.log.warn(problem, every=_LOGGED_EVERY)
        elif self._costmaps[layer].map is not None:
            self._changed.add(layer)

    def _on_particles(self, particles: Poses) -> None:
        self._particles = particles
        self._changed.add(Layer.PARTICLES)
