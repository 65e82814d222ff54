import functools
import math
from pathlib import Path

import numpy as np
import pytest
from tests.ur_nodes.vision.synthetic import Marker, drift, drive, look

from ur.worlds.world_file import read_world
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.rigid import angle_between, from_angles
from ur_nodes.vision.estimation.localise import FiducialLocaliser
from ur_nodes.vision.estimation.mapping import FiducialMapper
from ur_nodes.vision.fiducial_map import MapEntry

OFFICE = Path(__file__).resolve().parents[4] / "ubiquity_launches" / "n_simulator" / "worlds" / "office.yaml"
LAP = [(0.0, 0.0), (8.5, 0.0), (8.5, 2.5), (5.0, 2.0), (4.5, -2.0), (1.0, -1.5), (0.0, 0.0), (2.0, 0.0)]


@functools.cache
def markers() -> tuple[Marker, ...]:
    return tuple(
        Marker(each.id, from_angles(each.pose[:3], each.pose[3:]), each.size) for each in read_world(OFFICE).fiducials
    )


@functools.cache
def mapped() -> tuple[FiducialMapper, float, float]:
    """A mapper after a lap, how far it believes to be from the truth, and how far odometry does."""
    random, mapper = np.random.default_rng(1), FiducialMapper()
    for pose, said in drift(drive(LAP), random):
        mapper.add(said, look(pose, markers(), random))
    robot = mapper.robot(said)
    assert robot
    mapper.refine()
    off, odometry = (math.hypot(each.x - pose.x, each.y - pose.y) for each in (robot, said))
    return mapper, off, odometry


def test_map_of_a_lap_is_right_to_a_tenth_of_a_metre_and_three_degrees() -> None:
    mapper, off, odometry = mapped()
    truth = {marker.id: marker.pose for marker in markers()}
    assert len(mapper.fiducials) > 25
    shifts = [np.linalg.norm(pose[:3, 3] - truth[number][:3, 3]) for number, pose in mapper.fiducials.items()]
    turns = [angle_between(pose, truth[number]) for number, pose in mapper.fiducials.items()]
    assert np.sqrt(np.mean(np.square(shifts))) < 0.10
    assert np.degrees(np.sqrt(np.mean(np.square(turns)))) < 3.0
    assert off < 0.1 < odometry  # the lap closes although the wheels drift


def test_covariances_grow_with_the_distance_from_the_start() -> None:
    entries = {entry.id: entry for entry in mapped()[0].entries()}
    near, far = [
        np.mean([e.variance for e in entries.values() if low < np.linalg.norm(e.pose[:2, 3]) < high])
        for low, high in ((0.0, 3.0), (7.0, 99.0))
    ]
    assert 0.0 < near < far
    assert all(np.linalg.eigvalsh(entry.covariance).min() > 0.0 for entry in entries.values())
    assert all(entry.id not in entry.links for entry in entries.values())


def test_robot_finds_itself_on_the_map_and_follows() -> None:
    random, localiser = np.random.default_rng(5), FiducialLocaliser(mapped()[0].entries())
    offs = []
    for pose, said in drift(drive([(5.0, 0.0), (8.5, 0.0), (8.5, 2.5)]), random):
        localiser.add(said, look(pose, markers(), random))
        if robot := localiser.robot(said):
            offs.append(math.hypot(robot.x - pose.x, robot.y - pose.y))
    assert len(offs) > 50
    assert np.sqrt(np.mean(np.square(offs))) < 0.12
    assert 0.0 < localiser.covariance[0, 0] < 0.05


def test_robot_that_is_carried_away_finds_itself_again() -> None:
    random = np.random.default_rng(5)
    localiser = FiducialLocaliser(
        [MapEntry(each.id, each.pose, np.eye(6) * 1e-4) for each in markers()], start=Pose2(0.0, 0.0, 0.0)
    )
    for pose, said in drift(drive([(0.0, 0.0), (1.0, 0.0)]), random):
        localiser.add(said, look(pose, markers(), random))
    elsewhere = Pose2(8.0, 0.2, 0.0)
    for _ in range(20):
        localiser.add(said, look(elsewhere, markers(), random))
    robot = localiser.robot(said)
    assert robot
    assert math.hypot(robot.x - elsewhere.x, robot.y - elsewhere.y) < 0.2


def test_mapping_goes_on_from_a_known_map_without_knowing_where_the_robot_is() -> None:
    random = np.random.default_rng(2)
    known = [MapEntry(each.id, each.pose, np.eye(6) * 1e-5) for each in markers()[::2]]
    mapper = FiducialMapper(known, start=None)
    assert mapper.robot(Pose2(0.0, 0.0, 0.0)) is None
    for pose, said in drift(drive([(3.0, 0.0), (8.0, 0.0)]), random):
        mapper.add(said, look(pose, markers(), random))
    robot = mapper.robot(said)
    assert robot
    assert math.hypot(robot.x - pose.x, robot.y - pose.y) < 0.15
    assert len(mapper.fiducials) > len(known)


def test_standing_still_adds_nothing() -> None:
    random, mapper = np.random.default_rng(2), FiducialMapper()
    here = Pose2(0.0, 0.0, 0.0)
    changes = [mapper.add(here, look(here, markers(), random)) for _ in range(10)]
    assert changes == [True] + [False] * 9
    assert mapper.moments == 1


def test_nothing_seen_is_no_map() -> None:
    mapper = FiducialMapper()
    assert not mapper.add(Pose2(0.0, 0.0, 0.0), ())
    assert mapper.entries() == ()
    assert mapper.robot(Pose2(1.0, 0.0, 0.0)) == Pose2(0.0, 0.0, 0.0)


@pytest.mark.parametrize("seed", [1, 2])
def test_same_input_gives_the_same_map(seed: int) -> None:
    def build() -> dict[int, list[float]]:
        random, mapper = np.random.default_rng(seed), FiducialMapper()
        for pose, said in drift(drive([(0.0, 0.0), (1.5, 0.0)]), random):
            mapper.add(said, look(pose, markers(), random))
        return {number: pose.ravel().tolist() for number, pose in mapper.fiducials.items()}

    assert build() == build()
