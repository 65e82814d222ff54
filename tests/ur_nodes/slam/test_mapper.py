import math
from itertools import pairwise

import numpy as np
import pytest
from tests.ur_nodes.slam.rooms import CORRIDOR, ROOM, Floats, box, scan_at, walls_of

from ur_nodes.geometry.grid import OCCUPIED
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.slam.map_state import Edge
from ur_nodes.slam.mapper import ScanMapper
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.tracker import MapTracker

# A ring of corridors 2 m wide and 12 m long, with niches, so that every place looks different.
RING = walls_of(
    box(-1.0, -1.0, 13.0, 11.0), box(1.0, 1.0, 11.0, 9.0), box(4.0, -1.0, 4.6, -0.6), box(12.4, 3.0, 13.0, 4.1),
    box(7.0, 10.5, 7.3, 11.0), box(-1.0, 6.0, -0.7, 6.9), box(8.0, -1.0, 8.2, -0.7), box(2.0, 10.7, 3.0, 11.0),
)  # fmt: skip
LENGTHS = (12.0, 10.0, 12.0, 10.0)


def drive_round(step: float = 0.2) -> list[Pose2]:
    """Once round the ring and a little farther, in steps of `step` m."""
    poses = [Pose2(0.0, 0.0, 0.0)]
    for side, length in enumerate((*LENGTHS, 3.0)):
        poses += [poses[-1].compose(Pose2(step * n, 0.0, 0.0)) for n in range(1, round(length / step) + 1)]
        if side < 4:
            poses += [poses[-1].compose(Pose2(0.0, 0.0, turn)) for turn in np.linspace(0.2, math.pi / 2.0, 8)]
    return poses


def with_drift(poses: list[Pose2]) -> list[Pose2]:
    """Odometry that is 3 % long and turns 2 degrees a metre."""
    found = [poses[0]]
    for before, after in pairwise(poses):
        step = before.inverse().compose(after)
        way = math.hypot(step.x, step.y)
        found.append(found[-1].compose(Pose2(1.03 * step.x, step.y, step.yaw + math.radians(2.0) * way)))
    return found


def run(walls: Floats, poses: list[Pose2], odometry: list[Pose2] | None) -> ScanMapper:
    mapper = ScanMapper()
    for number, pose in enumerate(poses):
        mapper.add_scan(scan_at(walls, pose, 0.01, number), odometry[number] if odometry else None)
    return mapper


def worst_error(mapper: ScanMapper, poses: list[Pose2]) -> float:
    first = poses[0]
    return max(
        math.hypot(found.x - true.x, found.y - true.y)
        for found, true in zip(mapper.path().values(), (first.inverse().compose(pose) for pose in poses), strict=True)
    )


def test_loop_is_closed_with_odometry_that_drifts() -> None:
    poses = drive_round()
    odometry = with_drift(poses)
    assert math.hypot(odometry[-1].x - poses[-1].x, odometry[-1].y - poses[-1].y) > 1.0
    mapper = run(RING, poses, odometry)
    assert mapper.loops > 0
    assert worst_error(mapper, poses) < 0.1


def test_room_is_mapped_without_odometry() -> None:
    poses = [Pose2(0.02 * n, 0.3 * math.sin(0.05 * n), 0.02 * n) for n in range(60)]
    assert worst_error(run(ROOM, poses, None), poses) < 0.02


def test_wheels_that_spin_on_the_spot_move_nothing() -> None:
    poses = [Pose2(0.02 * min(n, 20), 0.0, 0.0) for n in range(40)]
    odometry = [Pose2(0.02 * n, 0.0, 0.0) for n in range(40)]
    assert worst_error(run(ROOM, poses, odometry), poses) < 0.02


def test_estimate_tells_how_far_the_robot_moved_whatever_the_wheels_did() -> None:
    mapper = ScanMapper()
    mapper.add_scan(scan_at(ROOM, Pose2(0.0, 0.0, 0.0), 0.01, 0), Pose2(0.0, 0.0, 0.0))
    step = mapper.add_scan(scan_at(ROOM, Pose2(0.0, 0.0, 0.0), 0.01, 1), Pose2(0.04, 0.0, 0.0)).step
    assert step
    assert math.hypot(step.x, step.y) < 0.01
    step = mapper.add_scan(scan_at(ROOM, Pose2(0.04, 0.0, 0.0), 0.01, 2), Pose2(0.08, 0.0, 0.0)).step
    assert step
    assert abs(step.x - 0.04) < 0.01


def test_map_does_not_grow_where_the_robot_drives_again() -> None:
    lap = [Pose2(0.6 * math.cos(0.1 * n), 0.6 * math.sin(0.1 * n), 0.1 * n + 0.5 * math.pi) for n in range(63)]
    once, often = run(ROOM, lap, lap), run(ROOM, lap * 4, lap * 4)
    assert len(often.scans) <= len(once.scans) + 2
    assert worst_error(often, lap * 4) < 0.02


NOTHING = scan_at(walls_of(box(90.0, 90.0, 91.0, 91.0)), Pose2(0.0, 0.0, 0.0))
AHEAD = [Pose2(0.1 * n, 0.0, 0.0) for n in range(30)]


@pytest.mark.parametrize("wheels", [True, False])
@pytest.mark.parametrize("make", [ScanMapper, MapTracker])
def test_map_begins_with_the_first_scan_that_has_points(make: type[ScanMapper | MapTracker], wheels: bool) -> None:
    mapper = make()
    for number, pose in enumerate(AHEAD):
        scan = scan_at(ROOM, pose, 0.01, number) if number >= 12 else NOTHING
        estimate = mapper.add_scan(scan, pose if wheels else None)
    assert estimate.located
    assert estimate.pose.x == pytest.approx(AHEAD[-1].x - AHEAD[12].x, abs=0.02)
    assert len(mapper.scans) > 1


def test_robot_that_leaves_what_it_sees_goes_on_by_its_odometry() -> None:
    mapper = ScanMapper()
    for number in range(200):
        pose = Pose2(0.2 * number, 0.0, 0.0)
        estimate = mapper.add_scan(NOTHING if number else scan_at(ROOM, pose), pose)
    assert estimate.pose.x == pytest.approx(0.2 * 199)
    assert not estimate.located


def test_keyframes_of_before_a_join_whose_place_is_uncertain_do_not_move_the_robot() -> None:
    before, after = run(ROOM, AHEAD, AHEAD), run(ROOM, AHEAD[:8], AHEAD[:8])
    place, last = Pose2(0.08, 0.08, 0.0), len(before.scans) - 1
    link = Edge(last, 0, before.keyframes[last].inverse().compose(place), np.eye(3), robust=True)
    before.join(after, place, [link])
    for number in range(5):
        estimate = before.add_scan(scan_at(ROOM, AHEAD[7], 0.01, number), Pose2(0.71 + 0.01 * number, 0.0, 0.0))
    expected = place.compose(AHEAD[7])
    assert math.hypot(estimate.pose.x - expected.x, estimate.pose.y - expected.y) < 0.01


def test_what_has_changed_replaces_the_scan_of_the_same_place() -> None:
    lap = [Pose2(0.04 * n, 0.0, 0.0) for n in (*range(30), *range(30, 0, -1))]
    chair = walls_of(box(0.5, -1.4, 0.9, -1.0))
    mapper = run(np.vstack((ROOM, chair)), lap, lap)
    before, count = list(mapper.scans), len(mapper.scans)
    for number, pose in enumerate(lap * 2):
        mapper.add_scan(scan_at(ROOM, pose, 0.01, 1000 + number), pose)
    assert len(mapper.scans) <= count + 2
    assert sum(one is not other for one, other in zip(before, mapper.scans, strict=False)) > 1
    drawn = OccupancyMap()
    drawn.update(mapper.keyframes, before + mapper.scans[count:])
    assert wall_at(drawn, 0.7, -1.0)
    drawn.update(mapper.keyframes, mapper.scans)
    assert not wall_at(drawn, 0.7, -1.0)
    fresh = OccupancyMap()
    fresh.update(mapper.keyframes, mapper.scans)
    low = np.rint(np.array(fresh.grid().origin[:2]) / 0.05 - np.array(drawn.grid().origin[:2]) / 0.05).astype(int)
    height, width = fresh.grid().values.shape
    part = drawn.grid().values[low[1] : low[1] + height, low[0] : low[0] + width]
    assert np.array_equal(part, fresh.grid().values)


def wall_at(drawn: OccupancyMap, x: float, y: float) -> bool:
    grid = drawn.grid()
    cells = grid.points_of_cells(np.argwhere(grid.values == OCCUPIED))
    return bool(np.any(np.hypot(*(cells - (x, y)).T) < 0.08))


def test_same_scans_give_the_same_map() -> None:
    poses = [Pose2(0.04 * n, 0.0, 0.01 * n) for n in range(30)]
    first, second = run(ROOM, poses, poses), run(ROOM, poses, poses)
    assert first.path() == second.path()
    assert wrap_angle(first.path()[len(poses) - 1].yaw - poses[-1].yaw) < 0.01


def test_corridor_without_a_landmark_is_as_straight_as_several_scans_tell() -> None:
    mapper, odometry, random = ScanMapper(), Pose2(0.0, 0.0, 0.0), np.random.default_rng(4)
    for number in range(60):
        scan = scan_at(CORRIDOR, Pose2(number - 30.0, 0.0, 0.0), 0.03, 400 + number, view=math.pi)
        estimate = mapper.add_scan(scan, odometry)
        odometry = odometry.compose(Pose2(1.0, 0.0, random.normal(0.0, 0.012)))
    assert abs(estimate.pose.yaw) < 0.015
    assert abs(estimate.pose.y) < 0.6
