import struct

import numpy as np
import pytest

from ur.web.wire.frames import Kind, Layer, generation_of, key_of
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, MapUpdate, Poses
from ur_nodes.web.layers.extra_layers import ExtraLayers

PLACES = {"map": Pose2(0.0, 0.0, 0.0), "odom": Pose2(1.0, 2.0, 0.5)}
LOCAL, GLOBAL = (f"move_base/{name}_costmap/costmap" for name in ("local", "global"))


class LayersWorld:
    """The layers, a robot whose navigation publishes them, and the frames that are sent."""

    def __init__(self) -> None:
        self.bus = Bus()
        self.node, robot = self.bus.node("web"), self.bus.node("robot")
        self.sent: list[bytes] = []
        self.layers = ExtraLayers(self.node, PLACES.get, lambda make: self.sent.extend(make()))
        self.local, self.whole = robot.publish(LOCAL, Map), robot.publish(GLOBAL, Map)
        self.updates = robot.publish(f"{GLOBAL}_updates", MapUpdate)
        self.particles = robot.publish("particlecloud", Poses, Quality.LATCHED)

    def want(self, *layers: int) -> None:
        self.layers.want(layers)
        self.step()

    def step(self) -> None:
        self.bus.run(1.0)
        self.layers.step(self.node.steady())
        self.bus.run(0.0)


def test_only_what_is_wanted_is_subscribed_to() -> None:
    world = LayersWorld()
    world.want(Layer.SCAN, Layer.MAP, 99)
    topics = (world.local, world.whole, world.updates, world.particles)
    assert [each.subscribers() for each in topics] == [0, 0, 0, 0]
    world.want(Layer.LOCAL, Layer.PARTICLES)
    assert [each.subscribers() for each in topics] == [1, 0, 0, 1]


def test_costmap_is_placed_in_the_map_and_forgotten_when_no_page_wants_it() -> None:
    world = LayersWorld()
    world.want(Layer.LOCAL)
    world.local.send(Map(0, "odom", Grid(np.full((30, 40), 50, np.int8), 0.05, Pose2(0.5, 0.0, 0.0))))
    world.step()
    grid, tile = world.sent
    assert key_of(grid)[:2] == (Kind.GRID, Layer.LOCAL)
    assert key_of(tile)[:2] == (Kind.TILE, Layer.LOCAL)
    expected = PLACES["odom"].compose(Pose2(0.5, 0.0, 0.0))
    assert struct.unpack_from("<4f", grid, 10)[1:] == pytest.approx(tuple(expected), abs=1e-5)
    world.want()
    assert world.local.subscribers() == 0
    assert generation_of(world.sent[-1]) != generation_of(grid)  # so that pages drop its tiles
    assert key_of(world.sent[-1])[:2] == (Kind.GRID, Layer.LOCAL)


def test_changes_of_the_global_costmap_send_only_their_tiles() -> None:
    world = LayersWorld()
    world.want(Layer.GLOBAL)
    world.whole.send(Map(0, "map", Grid(np.zeros((300, 600), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))))
    world.step()
    world.sent.clear()
    world.updates.send(MapUpdate(0, "map", 280, 10, np.full((2, 3), 100, np.int8)))
    world.step()
    assert [key_of(each) for each in world.sent] == [(Kind.GRID, Layer.GLOBAL, 0, 0), (Kind.TILE, Layer.GLOBAL, 0, 1)]
    world.updates.send(MapUpdate(0, "map", 299, 10, np.full((2, 3), 100, np.int8)))
    world.step()
    assert len(world.sent) == 2
    assert any("inside the grid of 600 x 300" in text for level, text in world.node.lines if level == "warn")


def test_particles_are_thinned_and_a_frame_that_is_not_known_is_left_out() -> None:
    world = LayersWorld()
    world.want(Layer.PARTICLES)
    poses = np.zeros((3000, 3))
    poses[:, 0] = 0.01 * np.arange(3000)
    world.particles.send(Poses(0, "elsewhere", poses))
    world.step()
    assert not world.sent
    world.particles.send(Poses(0, "map", poses))
    world.step()
    assert len(world.sent[0]) == 14 + 4 * 500
