from __future__ import annotations

import struct
from typing import Any

import numpy as np
import pytest

from ur.web.wire.frames import Kind, Layer, generation_of, key_of

pytest.importorskip("rospy", reason="ROS is not installed")

from geometry_msgs.msg import Point, Pose, PoseArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.rosio.grid_message import grid_message
from ur_nodes.rosio.grid_update import update_message
from ur_nodes.web.layers.layers_node import ExtraLayers

PLACES = {"map": Pose2(0.0, 0.0, 0.0), "odom": Pose2(1.0, 2.0, 0.5)}


class Topics:
    """Subscribers that nobody publishes to: their callbacks by topic."""

    def __init__(self) -> None:
        self.callbacks: dict[str, tuple[Any, tuple[Any, ...]]] = {}

    def subscribe(self, topic: str, _kind: Any, callback: Any, callback_args: Any = None, **_: int) -> Any:
        topics = self
        self.callbacks[topic] = callback, () if callback_args is None else (callback_args,)

        class Subscriber:
            def unregister(self) -> None:
                del topics.callbacks[topic]

        return Subscriber()

    def publish(self, topic: str, message: Any) -> None:
        callback, arguments = self.callbacks[topic]
        callback(message, *arguments)


@pytest.fixture
def topics() -> Topics:
    return Topics()


@pytest.fixture
def sent() -> list[bytes]:
    return []


@pytest.fixture
def layers(topics: Topics, sent: list[bytes]) -> ExtraLayers:
    return ExtraLayers(PLACES.get, sent.append, topics.subscribe)


def make_costmap(frame: str) -> Any:
    return grid_message(Grid(np.full((30, 40), 50, np.int8), 0.05, Pose2(0.5, 0.0, 0.0)), frame, None)


def test_only_what_is_wanted_is_subscribed_to(layers: ExtraLayers, topics: Topics) -> None:
    layers.want([Layer.SCAN, Layer.MAP, 99])
    layers.step(10.0)
    assert not topics.callbacks
    layers.want([Layer.LOCAL, Layer.PARTICLES])
    layers.step(11.0)
    assert set(topics.callbacks) == {"move_base/local_costmap/costmap", "particlecloud"}


def test_costmap_is_placed_in_the_map_and_forgotten_when_nobody_wants_it(
    layers: ExtraLayers, topics: Topics, sent: list[bytes]
) -> None:
    layers.want([Layer.LOCAL])
    layers.step(10.0)
    topics.publish("move_base/local_costmap/costmap", make_costmap("odom"))
    layers.step(11.0)
    grid, tile = sent
    assert key_of(grid)[:2] == (Kind.GRID, Layer.LOCAL)
    assert key_of(tile)[:2] == (Kind.TILE, Layer.LOCAL)
    expected = PLACES["odom"].compose(Pose2(0.5, 0.0, 0.0))
    assert struct.unpack_from("<4f", grid, 10)[1:] == pytest.approx(tuple(expected), abs=1e-5)
    layers.want([])
    layers.step(12.0)
    assert not topics.callbacks
    assert generation_of(sent[-1]) != generation_of(grid)  # so that pages drop its tiles
    assert key_of(sent[-1])[:2] == (Kind.GRID, Layer.LOCAL)


def test_changes_of_the_global_costmap_send_only_their_tiles(
    layers: ExtraLayers, topics: Topics, sent: list[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    warned: list[str] = []
    monkeypatch.setattr("rospy.logwarn_throttle", lambda _period, text: warned.append(text))
    layers.want([Layer.GLOBAL])
    layers.step(10.0)
    grid = Grid(np.zeros((300, 600), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))
    topics.publish("move_base/global_costmap/costmap", grid_message(grid, "map", None))
    layers.step(11.0)
    sent.clear()
    change = update_message(np.full((2, 3), 100, np.int8), 280, 10, "map", None)
    topics.publish("move_base/global_costmap/costmap_updates", change)
    layers.step(12.0)
    assert [key_of(each) for each in sent] == [(Kind.GRID, Layer.GLOBAL, 0, 0), (Kind.TILE, Layer.GLOBAL, 0, 1)]
    outside = update_message(np.full((2, 3), 100, np.int8), 299, 10, "map", None)
    topics.publish("move_base/global_costmap/costmap_updates", outside)
    layers.step(13.0)
    assert len(sent) == 2
    assert "inside the grid of 600 x 300" in warned[0]


def test_particles_are_thinned_and_a_frame_that_is_not_known_is_left_out(
    layers: ExtraLayers, topics: Topics, sent: list[bytes]
) -> None:
    layers.want([Layer.PARTICLES])
    layers.step(10.0)
    message = PoseArray(poses=[Pose(position=Point(0.01 * number, 0.0, 0.0)) for number in range(3000)])
    message.header.frame_id = "elsewhere"
    topics.publish("particlecloud", message)
    layers.step(11.0)
    assert not sent
    message.header.frame_id = "map"
    topics.publish("particlecloud", message)
    layers.step(12.0)
    assert len(sent[0]) == 14 + 4 * 500
