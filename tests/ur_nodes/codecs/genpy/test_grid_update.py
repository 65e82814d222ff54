from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest
import rospy
from genpy import DeserializationError
from std_msgs.msg import Header

from ur_nodes.codecs import find_codec
from ur_nodes.codecs.genpy.grid import GridUpdate
from ur_nodes.codecs.vision.fiducial_messages import make_classes
from ur_nodes.ports.values import MapUpdate


def test_grid_update_is_upstreams_message() -> None:
    fields = {"std_msgs/Header": Header._full_text, "OccupancyGridUpdate": GridUpdate._full_text.partition("=")[0]}
    upstream: Any = make_classes("map_msgs", fields)["OccupancyGridUpdate"]
    assert upstream._md5sum == GridUpdate._md5sum
    wire, message = io.BytesIO(), GridUpdate()
    update = MapUpdate(2_000_000_009, "map", 7, 3, np.array([[1, -1, 100], [0, 5, 6]], np.int8))
    find_codec(MapUpdate).fill(message, update)
    message.serialize(wire)
    read = upstream().deserialize(wire.getvalue())
    assert (read.x, read.y, read.width, read.height) == (3, 7, 3, 2)
    assert list(read.data) == [1, -1, 100, 0, 5, 6]
    assert (read.header.frame_id, read.header.stamp) == ("map", rospy.Time(2, 9))
    again = GridUpdate().deserialize(wire.getvalue())
    assert list(again.data) == list(read.data)
    with pytest.raises(DeserializationError):
        GridUpdate().deserialize(wire.getvalue()[:-1])
