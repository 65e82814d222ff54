import numpy as np
import pytest
from bench.navigation_parts.explored import align, surface_points
from tests.ur_nodes.slam.rooms import ROOM, scan_at

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.occupancy import OccupancyMap


def drawn_room(resolution: float, frame: Pose2) -> Grid:
    """A map of a room, in a frame that lies at a pose in the room."""
    drawn = OccupancyMap(resolution)
    poses = [Pose2(x, y, 0.3) for x in (-1.5, 0.0, 2.0, 3.0) for y in (-1.0, 0.5, 2.0)]
    drawn.update([frame.inverse().compose(pose) for pose in poses], [scan_at(ROOM, pose) for pose in poses])
    return drawn.grid()


def test_map_is_fitted_to_the_world_wherever_its_frame_lies() -> None:
    world = drawn_room(0.01, Pose2(0.0, 0.0, 0.0))
    frame = Pose2(0.06, -0.04, 0.02)
    pose, error = align(drawn_room(0.05, frame), world)
    assert pose == pytest.approx(frame, abs=0.008)
    assert error < 0.04


def test_surfaces_are_the_edges_of_walls_to_free_floor() -> None:
    values = np.full((3, 3), -1, np.int8)
    values[1, 1], values[1, 2] = 100, 0
    points = surface_points(Grid(values, 0.1, Pose2(1.0, 2.0, 0.0)), only_free=True)
    assert points[:, 0] == pytest.approx(np.full(len(points), 1.2))
    assert points[:, 1].min() == pytest.approx(2.1)
    assert points[:, 1].max() == pytest.approx(2.2, abs=0.011)
