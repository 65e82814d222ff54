from __future__ import annotations

import io
import math

import numpy as np
import pytest
import rospy
from genpy import DeserializationError
from nav_msgs.msg import OccupancyGrid
from nav_msgs.srv import GetMapResponse

from ur.source.diagnostic import UserError
from ur_nodes.codecs.genpy.grid import GridMessage, GridResponse
from ur_nodes.codecs.maps import fill_map, grid_of_message
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.validation import problem_of
from ur_nodes.ports.values import Map


def grid_message(grid: Grid) -> GridMessage:
    message = GridMessage()
    fill_map(message, Map(3_000_000_004, "map", grid))
    return message


def test_grid_survives_the_way_through_a_message() -> None:
    grid = Grid(np.array([[0, 100, -1], [50, 1, 99]], dtype=np.int8), 0.05, Pose2(-1.5, 2.0, 0.5))
    wire = io.BytesIO()
    grid_message(grid).serialize(wire)
    message = OccupancyGrid().deserialize(wire.getvalue())

    got = grid_of_message(message)

    assert np.array_equal(got.values, grid.values)
    assert got.resolution == 0.05  # not 0.0500000007
    assert math.dist(got.origin, grid.origin) < 1e-12
    assert (message.header.frame_id, message.header.stamp) == ("map", rospy.Time(3, 4))


def test_grid_of_message_refuses_data_of_another_size() -> None:
    message = OccupancyGrid()
    message.info.width, message.info.height, message.info.resolution = 3, 2, 0.1
    message.data = [0] * 5
    with pytest.raises(UserError, match="3 x 2 cells with 5 values"):
        grid_of_message(message)


def test_map_with_a_resolution_of_zero_has_a_problem() -> None:
    assert problem_of(grid_of_message(OccupancyGrid())).startswith("map with resolution 0, expected 0.0001")


def test_grid_messages_are_on_the_wire_what_upstreams_are() -> None:
    grid = Grid(np.array([[0, 100, -1], [50, 1, 99]], dtype=np.int8), 0.05, Pose2(-1.5, 2.0, 0.5))
    ours, theirs = io.BytesIO(), io.BytesIO()
    GridResponse(grid_message(grid)).serialize(ours)
    GetMapResponse(OccupancyGrid().deserialize(ours.getvalue())).serialize(theirs)
    assert ours.getvalue() == theirs.getvalue()
    assert np.array_equal(grid_of_message(GridResponse().deserialize(ours.getvalue()).map).values, grid.values)


def test_grid_message_refuses_bytes_that_end_too_early() -> None:
    wire = io.BytesIO()
    grid_message(Grid(np.zeros((2, 3), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))).serialize(wire)
    for length in (0, 10, 60, len(wire.getvalue()) - 1):
        with pytest.raises(DeserializationError):
            GridMessage().deserialize(wire.getvalue()[:length])
