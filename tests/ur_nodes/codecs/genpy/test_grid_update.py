from __future__ import annotations

import io

import numpy as np
import pytest
import rospy
from genpy import DeserializationError
from genpy.dynamic import generate_dynamic

from ur_nodes.codecs import find_codec
from ur_nodes.codecs.genpy.grid_update import GridUpdate
from ur_nodes.ports.values import MapUpdate


def test_grid_update_is_upstreams_message() -> None:
    upstream = generate_dynamic(GridUpdate._type, GridUpdate._full_text)[GridUpdate._type]
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
