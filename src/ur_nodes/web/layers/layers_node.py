"""Layers over the map that few want: costmaps and the localiser's particles, subscribed to while a page shows them."""

from __future__ import annotations

import threading
from collections.abc import Callable, Collection
from dataclasses import replace
from typing import Any

import numpy as np
import rospy
from geometry_msgs.msg import PoseArray

from ur.source.diagnostic import UserError
from ur.web.wire.frames import GridFrame, Layer, grid_frame, points_frame, tile_frame
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.grid_message import GridMessage, grid_of_message
from ur_nodes.rosio.grid_update import GridUpdate, apply_update
from ur_nodes.web.layers.pacing import Every
from ur_nodes.web.layers.tiles import Tiles, cut_tiles

_EVERY = 0.5  # s between two frames of a layer
_MOST_PARTICLES = 500
_COSTMAPS = {Layer.GLOBAL: "move_base/global_costmap/costmap", Layer.LOCAL: "move_base/local_costmap/costmap"}
_LOGGED_EVERY = 10.0  # s

Place = Callable[[str], "Pose2 | None"]


class ExtraLayers:
    """Sends the layers that are wanted. `place` tells the pose of a frame in the map frame, None: not known.

    `subscribe` makes subscribers, as rospy.Subscriber does.
    """

    def __init__(
        self, place: Place, send: Callable[[bytes], None], subscribe: Callable[..., Any] = rospy.Subscriber
    ) -> None:
        self._place, self._send, self._subscriber = place, send, subscribe
        self._lock = threading.Lock()
        self._wanted: frozenset[int] = frozenset()
        self._subscribers: dict[int, list[Any]] = {}
        self._grids: dict[int, tuple[str, Grid]] = {}
        self._particles: tuple[str, list[tuple[float, float]]] | None = None
        self._changed: set[int] = set()
        self._tiles: dict[int, Tiles] = {}
        self._send_every = Every(_EVERY)

    def want(self, layers: Collection[int]) -> None:
        """Have these layers sent, and no others."""
        self._wanted = frozenset(layers) & {*_COSTMAPS, Layer.PARTICLES}

    def step(self, now: float) -> None:
        """Subscribe to what is wanted, and send what has changed; to be called often, from one thread.

        `now` is time.monotonic().
        """
        if not self._send_every.due(now):
            return
        for layer in self._subscribers.keys() - self._wanted:
            self._drop(layer)
        for layer in self._wanted - self._subscribers.keys():
            self._subscribers[layer] = self._subscribe(layer)
        with self._lock:
            changed, self._changed = self._changed, set()
            # A local costmap moves in the map frame even where its cells stay.
            grids = {layer: self._grids[layer] for layer in changed & self._grids.keys()}
            grids = {layer: (frame, replace(grid, values=grid.values.copy())) for layer, (frame, grid) in grids.items()}
            particles = self._particles if Layer.PARTICLES in changed else None
        for layer, (frame, grid) in grids.items():
            self._send_grid(Layer(layer), frame, grid)
        if particles is not None:
            self._send_particles(*particles)

    def _subscribe(self, layer: int) -> list[Any]:
        if layer == Layer.PARTICLES:
            return [self._subscriber("particlecloud", PoseArray, self._on_particles, queue_size=1)]
        topic = _COSTMAPS[Layer(layer)]
        found = [self._subscriber(topic, GridMessage, self._on_grid, callback_args=layer, queue_size=1)]
        if layer == Layer.GLOBAL:
            found.append(self._subscriber(f"{topic}_updates", GridUpdate, self._on_update, callback_args=layer))
        return found

    def _drop(self, layer: int) -> None:
        """Unsubscribe, and have pages forget what they have: it is old when somebody wants the layer again."""
        for subscriber in self._subscribers.pop(layer):
            subscriber.unregister()
        with self._lock:
            self._grids.pop(layer, None)
            self._changed.discard(layer)
            if layer == Layer.PARTICLES:
                self._particles = None
        if layer == Layer.PARTICLES:
            self._send(points_frame(Layer.PARTICLES, []))
            return
        before = self._tiles.pop(layer, Tiles()).frame
        if before is not None:
            empty = GridFrame(before.generation + 1, before.resolution, before.origin, 0, 0, 0, 0)
            self._tiles[layer] = Tiles(empty)
            self._send(grid_frame(Layer(layer), empty))

    def _send_grid(self, layer: Layer, frame_id: str, grid: Grid) -> None:
        place = self._place(frame_id)
        if place is None:
            return
        grid = replace(grid, origin=place.compose(grid.origin))
        self._tiles[layer], changed = cut_tiles(self._tiles.get(layer, Tiles()), grid)
        frame = self._tiles[layer].frame
        assert frame is not None, "made from a grid"
        self._send(grid_frame(layer, frame))
        for column, row in changed:
            cells = self._tiles[layer].tiles[column, row].tobytes()
            self._send(tile_frame(layer, frame.generation, column, row, cells))

    def _send_particles(self, frame_id: str, points: list[tuple[float, float]]) -> None:
        place = self._place(frame_id)
        if place is not None and points:
            self._send(points_frame(Layer.PARTICLES, place.transform_points(np.array(points)).tolist()))

    @quiet_at_end
    def _on_grid(self, message: GridMessage, layer: int) -> None:
        try:
            grid = grid_of_message(message)
        except UserError as problem:
            rospy.logwarn_throttle(_LOGGED_EVERY, str(problem))
            return
        with self._lock:
            self._grids[layer] = message.header.frame_id, replace(grid, values=grid.values.copy())
            self._changed.add(layer)

    @quiet_at_end
    def _on_update(self, message: GridUpdate, layer: int) -> None:
        with self._lock:
            if layer not in self._grids:
                return
            try:
                apply_update(self._grids[layer][1].values, message)
            except UserError as problem:  # as after a change of the map's size, before the new costmap arrives
                rospy.logwarn_throttle(_LOGGED_EVERY, str(problem))
                return
            self._changed.add(layer)

    @quiet_at_end
    def _on_particles(self, message: Any) -> None:
        step = max(1, -(-len(message.poses) // _MOST_PARTICLES))
        points = [(each.position.x, each.position.y) for each in message.poses[::step]]
        with self._lock:
            self._particles = message.header.frame_id, points
            self._changed.add(Layer.PARTICLES)
