"""The node `slam_gmapping` on a bus: a simulated robot in the maze; map -> odom is compared with the truth."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

from ur.maps.store import own_store
from ur.robot.base import load_base
from ur.source.diagnostic import UserError
from ur.source.project import launch_library
from ur.worlds.world_file import read_world
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.geometry.scan import directions_of_scan, mount_of_pose
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, Trigger
from ur_nodes.ports.values import Imu, Map, MapInfo, Number, Result, Scan, Transform
from ur_nodes.simulator.simulation import Simulation
from ur_nodes.slam.gmapping.slam import entropy
from ur_nodes.slam.matching.scan import make_scan
from ur_nodes.slam.slam_gmapping_node import SlamGmappingNode
from ur_nodes.slam.storage.writer import load_poses
from ur_nodes.slam.tracker import MapTracker

BASE = load_base(launch_library(), "stage", "")
WORLD = read_world(launch_library() / "n_simulator" / "worlds" / "maze.yaml")
UPSIDE_DOWN_YAW = 2.0  # rad: how a lidar that hangs upside down is turned besides
assert BASE.lidar
LIDAR = BASE.lidar
MOUNT = Pose2(LIDAR.pose[0], LIDAR.pose[1], LIDAR.pose[5]).in_space()


class SlamStage:
    """A robot in the maze with the node, in lock step with the time of the bus."""

    def __init__(self, **parameters: object) -> None:
        self.bus = Bus()
        self.robot = self.bus.node("robot")
        self.simulation = Simulation(WORLD, BASE, seed=1)
        self.used: list[tuple[Scan, Pose2]] = []  # scans, and odometry at them
        self.entropies: list[float] = []
        self.corrections: list[Transform] = []
        self.maps: list[Map] = []
        self.infos: list[MapInfo] = []
        self.upside_down = self.halves = False
        self._scan, self._rear = self.robot.publish("scan", Scan), self.robot.publish("rear_scan", Scan)
        self._imu = self.robot.publish("imu", Imu, Quality.EVERY)
        self.robot.subscribe("slam_gmapping/entropy", Number, lambda got: self.entropies.append(got.value))
        self.robot.subscribe("map", Map, self.maps.append)
        self.robot.subscribe("map_metadata", MapInfo, self.infos.append)
        self.robot.subscribe("/tf", tuple, self.take_transforms, Quality.EVERY)
        self.start(**parameters)

    def start(self, **parameters: object) -> None:
        """Start the node, instead of one that runs."""
        for name, value in ({"base_frame": "base_footprint"} | parameters).items():
            self.bus.parameters[f"/slam_gmapping/{name}"] = value
        self.node = self.bus.node("slam_gmapping")
        self._wired = SlamGmappingNode(self.node)

    def keyframes(self) -> int:
        """Their number so far."""
        return len(self._wired._slam.state().scans)

    def drive(self, linear: float, angular: float, seconds: float) -> float:
        """Drive; the distance (m) between the true pose and the published one at the end."""
        half = 0.5 * UPSIDE_DOWN_YAW  # rolled by half a turn, then turned
        mount = Pose3(*MOUNT[:3], math.cos(half), math.sin(half), 0.0, 0.0) if self.upside_down else MOUNT
        self.robot.transforms.send(Transform(self.bus.now, "base_footprint", "laser", mount, fixed=True))
        end = self.simulation.time + seconds
        while self.simulation.time < end:
            before = self.simulation.time
            self.simulation.command(0, linear, angular)
            scan = "scan" in self.simulation.advance().due
            self.bus.run(self.simulation.time - before)
            if scan:
                self._send()
        self.bus.run(0.2)  # the transform is sent again
        found = self.corrections[-1]
        pose = found.pose.planar()
        if found.child == "odom":
            pose = pose.compose(Pose2(*self.simulation.odometry(0).pose))
        return math.dist(pose[:2], self.simulation.pose(0)[:2])

    def ask(self, service: str, request: object) -> Result:
        answers: list[Result] = []
        self.robot.call(service, request, answers.append)
        assert self.bus.run_until(lambda: bool(answers), 10.0)
        return answers[0]

    def log(self) -> str:
        return "\n".join(text for _, text in self.node.lines)

    def take_transforms(self, transforms: tuple[Transform, ...]) -> None:
        self.corrections += [each for each in transforms if each.parent == "map"]

    def _send(self) -> None:
        stamp, ranges = self.bus.now, np.array(self.simulation.scan(0), np.float32)
        odometry = Pose2(*self.simulation.odometry(0).pose)
        if self.halves:
            quarter, turning = len(ranges) // 4, self.simulation.odometry(0).velocity[1]
            front = np.zeros(len(ranges), np.bool_)
            front[quarter:-quarter] = True
            self._imu.send(Imu(stamp, "laser", (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, turning), (0.0, 0.0, 9.8)))
            self._rear.send(self._value(stamp, np.where(front, np.float32(np.inf), ranges)))
            ranges = np.where(front, ranges, np.float32(np.inf))
        scan = self._value(stamp, ranges)
        self._scan.send(scan)  # before its odometry: the node waits for that
        self.used.append((scan, odometry.in_space().planar()))  # as it travels
        self.robot.transforms.send(Transform(stamp, "odom", "base_footprint", odometry.in_space()))
        self.bus.run(0.0)

    def _value(self, stamp: int, ranges: np.ndarray[tuple[int], np.dtype[np.float32]]) -> Scan:
        step = (LIDAR.angle_max - LIDAR.angle_min) / (LIDAR.samples - 1)
        first = UPSIDE_DOWN_YAW - LIDAR.pose[5] - LIDAR.angle_max if self.upside_down else LIDAR.angle_min
        seen = ranges[::-1] if self.upside_down else ranges  # angles count the other way round
        return Scan(stamp, "laser", first, step, LIDAR.range_min, LIDAR.range_max, seen)


def share_on_walls(grid: Grid) -> float:
    """The share (0..1) of the occupied cells within 0.1 m of a wall of the world."""
    plan = WORLD.floor_plan
    floor = Grid(np.where(plan.walls, 100, 0).astype(np.int8), plan.resolution, Pose2(*plan.origin))
    walls = cKDTree(floor.points_of_cells(np.argwhere(plan.walls)))
    return float(np.mean(walls.query(grid.points_of_cells(np.argwhere(grid.values == 100)))[0] < 0.1))


def test_map_is_published_and_answered_and_the_transform_is_sent_at_its_rate() -> None:
    stage = SlamStage()
    assert not stage.ask("dynamic_map", AskMap()).success
    assert stage.drive(0.0, 0.8, 3.0) < 0.02
    assert len(stage.maps) == 1
    assert stage.drive(0.0, -0.8, 3.0) < 0.02
    assert len(stage.maps) == 2  # with the first scan, and every 5 s
    assert stage.infos[-1].resolution == 0.05
    found = stage.ask("dynamic_map", AskMap()).value
    assert isinstance(found, Map)
    assert found.frame == stage.maps[-1].frame == "map"
    assert np.sum(found.grid.values == 100) > 100
    assert np.sum(found.grid.values == 0) > 500
    assert share_on_walls(found.grid) > 0.97
    stamps = np.diff([each.stamp for each in stage.corrections])
    assert set(stamps.tolist()) == {50_000_000}


def test_estimates_are_those_of_the_mapper_to_the_last_bit() -> None:
    stage = SlamStage()
    stage.drive(0.2, 0.8, 2.0)
    tracker = MapTracker()
    mount = mount_of_pose(MOUNT)
    estimates = []
    for scan, odometry in stage.used:
        seen = make_scan(scan.ranges, directions_of_scan(scan), (scan.range_min, scan.range_max), mount)
        estimates.append(tracker.add_scan(seen, odometry))
    assert len(estimates) > 10
    assert stage.entropies == [entropy(each) for each in estimates]
    last = estimates[-1].pose.compose(stage.used[-1][1].inverse())
    assert stage.corrections[-1].pose == last.in_space()


def test_map_is_made_without_odometry() -> None:
    stage = SlamStage(odom_frame="")
    assert stage.drive(0.2, 0.3, 3.0) < 0.03
    assert stage.corrections[-1].child == "base_footprint"


def test_map_is_made_with_a_lidar_that_hangs_upside_down_and_is_turned() -> None:
    stage = SlamStage()
    stage.upside_down = True
    assert stage.drive(0.2, 0.4, 3.0) < 0.03
    assert np.sum(stage.maps[0].grid.values == 100) > 50


def test_map_is_made_with_two_lidars_that_see_half_each_and_a_gyroscope() -> None:
    stage = SlamStage(other_scans="rear_scan")
    stage.halves = True
    assert stage.drive(0.0, 0.8, 9.0) < 0.03
    assert np.sum(stage.maps[-1].grid.values == 100) > 100
    assert "no scan on rear_scan" not in stage.log()
    assert "contradict the scans" not in stage.log()


def test_lidar_that_sends_nothing_is_left_out_with_a_reason() -> None:
    stage = SlamStage(other_scans="rear_scan")
    stage.drive(0.0, 0.8, 2.0)
    assert "no scan on rear_scan at the time of that on scan; it is left out" in stage.log()


def test_robot_that_is_carried_elsewhere_while_it_maps_is_found_and_nothing_is_mapped_double() -> None:
    stage = SlamStage(map_update_interval=1.0)
    stage.drive(0.0, 0.8, 3.0)
    stage.drive(0.3, 0.0, 4.0)
    stage.simulation.set_pose("robot", (0.0, 0.0, -1.0))  # odometry does not notice
    assert stage.drive(0.15, 0.5, 8.0) < 0.05
    assert share_on_walls(stage.maps[-1].grid) > 0.97
    assert "lost: looking for the place on the map" in stage.log()
    assert "found again at" in stage.log()


def test_every_second_scan_is_used_where_half_of_them_are_to_be() -> None:
    stage = SlamStage(throttle_scans=2)
    stage.drive(0.0, 0.8, 2.0)
    assert len(stage.entropies) == len(stage.used) // 2


def test_map_is_saved_again_and_again_on_request_and_at_the_end_and_continued(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    store = own_store({"XDG_DATA_HOME": str(tmp_path)})
    stage = SlamStage(store=True, map_name="flat", save_every=2.0, latest=True)
    assert stage.ask("slam_gmapping/save", Trigger()).text == "there is no map yet; is the lidar driver running?"
    stage.drive(0.2, 0.0, 1.0)
    assert store.record("flat").keyframes == 0
    stage.drive(0.1, 0.0, 2.0)
    assert store.latest() == "flat"
    saved = store.record("flat").keyframes
    stage.drive(0.4, 0.0, 1.0)
    assert stage.ask("slam_gmapping/save", Trigger()) == Result(True, "flat")
    asked = store.record("flat").keyframes
    assert 0 < saved < asked
    with pytest.raises(UserError, match="map 'flat' is in use"), store.claim("flat"):
        pass
    stage.drive(0.2, 0.3, 2.5)
    stage.node.end("the test goes on")
    assert "map 'flat' saved; navigate on it with: ur run keyboard_navigate map:=flat" in stage.log()
    poses, edges, scans = load_poses(store.path("flat"), store.record("flat"))
    assert len(poses) == len(scans) <= len(edges) + 1
    assert len(poses) > asked
    assert load_map(store.picture("flat")).width > 50

    stage.start()
    assert "continuing the map 'flat'; looking for the place on it" in stage.log()
    assert stage.drive(0.0, 0.5, 4.0) < 0.05
    assert "found again at" in stage.log()
    stage.node.end("the test is over")
    more = load_poses(store.path("flat"), store.record("flat"))[0]
    assert len(more) > len(poses)
    assert np.array(more[: len(poses)]) == pytest.approx(np.array(poses), abs=0.02)


def test_map_that_cannot_be_written_is_reported(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    stage = SlamStage(store=True, map_name="flat", save_every=1.0)
    folder = own_store({"XDG_DATA_HOME": str(tmp_path)}).path("flat")
    (folder / "map.pgm").mkdir()
    stage.drive(0.2, 0.0, 3.0)
    reports = [text for level, text in stage.node.lines if level == "error"]
    assert len(reports) == 1
    assert reports[0].startswith(f"the map cannot be written: {folder}")
    assert reports[0].endswith("; is the disk full?")


def test_bad_parameter_is_refused() -> None:
    with pytest.raises(UserError, match=r"parameter /slam_gmapping/delta: 0, expected a number from 0\.01 to 1"):
        SlamStage(delta=0)
