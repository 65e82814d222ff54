"""The node `amcl` on a bus: a robot without physics drives on a map, and the transform map -> odom is compared."""

import math
import re

import numpy as np
import pytest
from tests.ur_nodes.navigation.synthetic import ANGLES, LASER, RANGE_MAX, Drifter, cast_rays

from ur.source.diagnostic import UserError
from ur.source.project import launch_library
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation.amcl_node import AmclNode
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, Silent, UseMap
from ur_nodes.ports.values import Map, PoseEstimate, Poses, Result, Scan, Transform

MAZE = load_map(launch_library() / "n_map_server/maps/maze.yaml")
NOWHERE = np.zeros((3, 3))
PARAMETERS = {
    "base_frame_id": "base_footprint",
    "update_min_d": 0.05,
    "update_min_a": 0.05,
    "resample_interval": 1,
    "min_particles": 200,
    "max_particles": 20000,
    "kld_err": 0.05,
    "kld_z": 2.33,
    "odom_model_type": "diff-corrected",
    **{f"odom_alpha{number}": 0.02 for number in (1, 2, 3, 4)},
    "laser_max_beams": 60,
    "laser_sigma_hit": 0.1,
    "laser_z_rand": 0.1,
    "save_pose_rate": 1000.0,
    "initial_cov_xx": 0.04,
    "initial_cov_yy": 0.04,
}


class AmclStage:
    """One robot on one map, which moves only when told; every move is sent with odometry, then a scan."""

    def __init__(self, grid: Grid, **parameters: object) -> None:
        self.bus = Bus()
        self.bus.parameters.update({f"/amcl/{name}": value for name, value in (PARAMETERS | parameters).items()})
        self.robot = Drifter(Pose2(0.0, 0.0, 0.0), np.random.default_rng(1))
        self.robot_node = self.bus.node("robot")
        self.estimates: list[PoseEstimate] = []
        self.clouds: list[Poses] = []
        self._grid = grid
        self._rng = np.random.default_rng(1)
        self._scan = self.robot_node.publish("scan", Scan)
        self._place = self.robot_node.publish("initialpose", PoseEstimate)
        self.robot_node.transforms.send(
            Transform(self.bus.now, "base_footprint", "laser", LASER.in_space(), fixed=True)
        )
        self.robot_node.serve("static_map", AskMap, lambda _request: Result(True, value=self.map))
        self.robot_node.subscribe("amcl_pose", PoseEstimate, self.estimates.append)
        self.robot_node.subscribe("particlecloud", Poses, self.clouds.append)
        self.start()

    @property
    def map(self) -> Map:
        return Map(self.bus.now, "map", self._grid)

    def start(self) -> None:
        """Start the node, instead of one that runs."""
        self.node = self.bus.node("amcl")
        AmclNode(self.node)
        self.bus.run(0.1)

    def drive(self, steps: int, distance: float, turn: float) -> list[float]:
        """Move; the error (m) of map -> odom, composed with the odometry, after each step."""
        return [self._step(distance, turn) for _ in range(steps)]

    def place(self, pose: Pose2, frame: str = "map") -> None:
        self._place.send(PoseEstimate(0, frame, pose, np.diag((0.04, 0.04, 0.02))))
        self.bus.run(0.01)

    def ask(self, service: str, request: object) -> Result:
        answers: list[Result] = []
        self.robot_node.call(service, request, answers.append)
        assert self.bus.run_until(lambda: bool(answers), 10.0)
        return answers[0]

    def log(self) -> str:
        return "\n".join(text for _, text in self.node.lines)

    def _step(self, distance: float, turn: float) -> float:
        self.robot.drive(distance, turn)
        stamp = self.bus.now
        self._scan.send(self._scan_value(stamp))  # before its odometry: the node waits for that
        self.robot_node.transforms.send(Transform(stamp, "odom", "base_footprint", self.robot.odometry.in_space()))
        self.bus.run(0.2)
        found = self.robot_node.transforms.find_planar("map", "odom", stamp + 100_000_000)
        assert found is not None
        return math.dist(found.compose(self.robot.odometry)[:2], self.robot.truth[:2])

    def _scan_value(self, stamp: int) -> Scan:
        ranges = cast_rays(self._grid, self.robot.truth.compose(LASER))
        noisy = (ranges + self._rng.normal(0.0, 0.01, len(ranges))).astype(np.float32)
        return Scan(stamp, "laser", float(ANGLES[0]), float(ANGLES[1] - ANGLES[0]), 0.1, RANGE_MAX, noisy)


def test_follows_the_robot_and_finds_it_after_a_kidnapping_and_a_restart() -> None:
    stage = AmclStage(MAZE)
    errors = stage.drive(20, 0.04, 0.02)
    assert max(errors) < 0.1
    assert sum(errors) / len(errors) < 0.03
    newest = stage.estimates[-1]
    assert newest.frame == "map"
    assert 0.7 < newest.pose.x < 0.9
    assert abs(newest.pose.y) < 0.3
    assert 0.0 < newest.covariance[0, 0] < 0.05
    assert len(stage.clouds[-1].poses) >= 200

    stage.robot.truth = Pose2(12.35, 8.97, 0.4)  # odometry does not notice
    assert min(stage.drive(3, 0.0, 0.1)) > 1.0
    assert stage.ask("global_localization", Silent()).success
    assert max(stage.drive(40, 0.0, 0.1)[-3:]) < 0.05

    stage.robot.truth = Pose2(0.0, 0.0, 0.0)
    stage.place(Pose2(0.1, -0.1, 0.1))
    assert max(stage.drive(15, 0.04, 0.0)[-3:]) < 0.05

    for name in [name for name in stage.bus.parameters if name.startswith("/amcl/initial_cov")]:
        assert 0.0 < stage.bus.parameters[name] < 0.1
    stage.start()
    assert max(stage.drive(5, 0.04, 0.0)) < 0.1  # from x = 0.6 m, not from the origin


def test_equal_inputs_give_equal_estimates_to_the_last_bit() -> None:
    one, other = AmclStage(MAZE), AmclStage(MAZE)
    assert one.drive(5, 0.1, 0.1) == other.drive(5, 0.1, 0.1)
    assert one.estimates[-1].pose == other.estimates[-1].pose
    assert np.array_equal(one.clouds[-1].poses, other.clouds[-1].poses)


def test_names_places_that_look_alike_and_what_tells_them_apart() -> None:
    values = np.zeros((84, 204), np.int8)
    values[:2] = values[-2:] = values[:, :2] = values[:, 101:103] = values[:, -2:] = 100
    values[20:40, 20:30] = values[20:40, 121:131] = 100  # a cupboard in each of two rooms
    values[8:12, 109:113] = 100  # and a box behind the second one
    stage = AmclStage(Grid(values, 0.05, Pose2(0.0, 0.0, 0.0)))
    stage.robot.truth = Pose2(3.0, 3.0, 0.0)
    stage.drive(1, 0.0, 0.1)
    stage.ask("global_localization", Silent())
    stage.drive(12, 0.0, 0.1)
    expected = (
        r"2 places on the map fit: \S+ \S+, \S+ \S+; the first two differ 3\.\d m [a-z ]+ of the robot: drive there"
    )
    assert re.search(expected, stage.log()), stage.log()


def test_first_map_of_the_topic_is_kept_where_it_is_asked_for() -> None:
    stage = AmclStage(MAZE, use_map_topic=True, first_map_only=True)
    maps = stage.robot_node.publish("map", Map, Quality.LATCHED)
    maps.send(stage.map)
    stage.bus.run(0.1)
    maps.send(Map(stage.bus.now, "map", Grid(np.zeros((4, 5), np.int8), 0.05, Pose2(0.0, 0.0, 0.0))))
    stage.bus.run(0.1)
    assert stage.log().count("map of") == 1
    assert max(stage.drive(3, 0.04, 0.0)) < 0.1


def test_map_of_the_service_replaces_the_one_in_use_and_places_the_robot() -> None:
    stage = AmclStage(MAZE)
    stage.drive(2, 0.04, 0.0)
    stage.robot.truth = Pose2(1.0, 0.0, 0.0)
    pose = Pose2(1.0, 0.0, 0.0)
    assert stage.ask("set_map", UseMap(stage.map, 0, "map", pose, np.diag((0.01, 0.01, 0.01)))).success
    assert max(stage.drive(5, 0.04, 0.0)) < 0.1


def test_place_in_another_frame_or_without_a_map_is_refused_with_a_reason() -> None:
    stage = AmclStage(MAZE)
    stage.place(Pose2(1.0, 1.0, 0.0), frame="odom")
    assert "initialpose in frame 'odom' ignored, expected 'map'" in stage.log()
    stage.place(Pose2(math.nan, 1.0, 0.0))
    assert "/initialpose: message of /robot ignored: a coordinate is nan" in stage.log()
    stage.place(Pose2(1e5, 1.0, 0.0))
    assert "initialpose at x 100000 m, y 1 m ignored, expected a place on the map" in stage.log()


def test_service_says_that_there_is_no_map_yet() -> None:
    stage = AmclStage(MAZE, use_map_topic=True)
    answer = stage.ask("global_localization", Silent())
    assert not answer.success
    assert answer.text == "there is no map with free cells yet, expected one"


def test_silence_is_explained() -> None:
    stage = AmclStage(MAZE)
    stage.bus.run(20.0)
    assert "no scan on /scan for 15 s; is the lidar driver running?" in stage.log()


def test_parameter_that_cannot_be_used_is_named() -> None:
    expected = "parameter /amcl/odom_model_type: 'dif', expected one of diff, diff-corrected, omni, omni-corrected"
    with pytest.raises(UserError, match=expected):
        AmclStage(MAZE, odom_model_type="dif")
