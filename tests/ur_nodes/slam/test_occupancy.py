import math

import numpy as np
from tests.ur_nodes.slam.rooms import ROOM, box, scan_at, walls_of

from ur_nodes.geometry.grid import FREE, OCCUPIED, UNKNOWN
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.occupancy import OccupancyMap


def value_at(drawn: OccupancyMap, x: float, y: float) -> int:
    return int(drawn.grid().values_at(np.array((x, y))))


def test_walls_are_occupied_floor_is_free_and_the_rest_unknown() -> None:
    drawn = OccupancyMap()
    pose = Pose2(0.02, 0.02, 0.3)
    assert drawn.update([pose], [scan_at(ROOM, pose)])
    assert value_at(drawn, 3.99 + 0.02, 0.5) == OCCUPIED
    assert value_at(drawn, 2.5, 0.3) == FREE
    assert value_at(drawn, 4.3, 0.5) == UNKNOWN


def test_thin_wall_that_is_seen_at_a_small_angle_is_kept() -> None:
    walls = np.vstack((walls_of(box(-5.0, -1.5, 5.0, 1.5)), [[(-2.0, 0.02), (2.0, 0.02)]]))
    poses = [Pose2(x, y, 0.1) for x in np.arange(-4.0, 4.1, 0.25) for y in (-0.3, 0.34)]
    drawn = OccupancyMap()
    drawn.update(poses, [scan_at(walls, pose, 0.01, seed) for seed, pose in enumerate(poses)])
    places = np.column_stack((np.arange(-1.95, 1.96, 0.05), np.full(79, 0.02)))
    assert np.mean(drawn.grid().values_at(places) == OCCUPIED) > 0.95


def test_edges_of_drawn_walls_lie_on_their_surfaces_wherever_these_are_in_a_cell() -> None:
    errors = []
    for place in np.arange(0.0, 0.05, 0.005):
        walls = walls_of(box(-2.0, -2.0, 2.0 + place, 2.0))
        poses = [Pose2(0.1 * n, 0.05 * n, 0.0) for n in range(6)]
        drawn = OccupancyMap()
        drawn.update(poses, [scan_at(walls, pose, 0.01, seed) for seed, pose in enumerate(poses)])
        grid = drawn.grid()
        for y in np.arange(-1.0, 1.0, 0.05):
            beam = np.arange(1.5, 2.4, 0.05)
            wall = grid.values_at(np.column_stack((beam, np.full(len(beam), y)))) == OCCUPIED
            column = grid.cells_of_points(np.array((beam[int(wall.argmax())], y)))[1]
            errors.append(grid.origin.x + column * grid.resolution - (2.0 + place))
    assert abs(np.mean(errors)) < 0.005
    assert np.abs(errors).max() < 0.045


def test_person_who_has_gone_is_forgotten() -> None:
    pose = Pose2(0.02, 0.02, 0.0)
    person = np.vstack((ROOM, walls_of(box(2.0, -0.2, 2.3, 0.2))))
    drawn = OccupancyMap()
    poses = [pose] * 6
    drawn.update(poses[:1], [scan_at(person, pose)])
    assert value_at(drawn, 2.01, 0.02) == OCCUPIED
    drawn.update(poses, [scan_at(person, pose)] + [scan_at(ROOM, pose)] * 5)
    assert value_at(drawn, 2.01, 0.02) == FREE


def test_furniture_that_was_moved_between_drives_is_drawn_where_it_was_seen_last() -> None:
    pose = Pose2(0.02, 0.02, 0.0)
    before, after = (np.vstack((ROOM, walls_of(box(x, -0.2, x + 0.3, 0.2)))) for x in (2.0, 3.0))
    scans = [scan_at(before, pose)] * 8 + [scan_at(after, pose)] * 2
    drawn = OccupancyMap()
    drawn.update([pose] * 8, scans[:8])
    assert value_at(drawn, 2.01, 0.02) == OCCUPIED
    assert value_at(drawn, 3.01, 0.02) == UNKNOWN
    drawn.update([pose] * 10, scans, drives=[8])
    assert value_at(drawn, 2.01, 0.02) == FREE
    assert value_at(drawn, 3.01, 0.02) == OCCUPIED


def test_keyframe_that_moves_leaves_nothing_behind() -> None:
    scans = [scan_at(ROOM, Pose2(0.0, 0.0, 0.0))]
    moved, fresh = OccupancyMap(), OccupancyMap()
    moved.update([Pose2(1.0, 0.5, 0.7)], scans)
    moved.update([Pose2(0.02, 0.02, 0.0)], scans)
    fresh.update([Pose2(0.02, 0.02, 0.0)], scans)
    assert moved.grid().values.max() == OCCUPIED
    for place in ROOM.reshape(-1, 2) * 0.99:
        assert value_at(moved, *place) == value_at(fresh, *place)
    assert (moved.grid().values >= 0).sum() == (fresh.grid().values >= 0).sum()


def test_drawing_in_steps_ends_with_the_same_map() -> None:
    poses = [Pose2(0.3 * n, 0.1 * n, 0.2 * n) for n in range(4)]
    scans = [scan_at(ROOM, pose) for pose in poses]
    steps, whole = OccupancyMap(), OccupancyMap()
    whole.update(poses, scans)
    assert [steps.update(poses, scans, most=1) for _ in range(4)] == [False, False, False, True]
    assert np.array_equal(steps.grid().values, whole.grid().values)


def test_map_reaches_as_far_as_it_is_told() -> None:
    drawn = OccupancyMap()
    drawn.include((-10.0, -5.0), (10.0, 20.0))
    grid = drawn.grid()
    assert grid.origin.x <= -10.0
    assert grid.origin.y + grid.height * grid.resolution >= 20.0
    assert not math.isnan(grid.origin.y)
    assert (grid.values == UNKNOWN).all()
