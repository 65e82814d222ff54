"""Parameters that are set while their node runs on a bus: the effect of each, and those that are refused."""

from pathlib import Path

import numpy as np
import pytest
from tests.ur_nodes.exploration.drawn import ROOM
from tests.ur_nodes.exploration.test_explore_node import ExploreWorld
from tests.ur_nodes.localisation.test_amcl_node import MAZE, AmclStage
from tests.ur_nodes.motion.mux_robot import LeaseDriver, MuxRobot
from tests.ur_nodes.navigation.robot_stage import RobotStage
from tests.ur_nodes.slam.test_slam_gmapping_node import SlamStage

from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.motion.joystick.teleop_twist_joy_node import start as start_joystick
from ur_nodes.motion.velocity_smoother_node import start as start_smoother
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Joystick, Map, Twist
from ur_nodes.ports.values import Path as PathValue
from ur_nodes.teleop.keyboard.pipe_driver import PipeDriver
from ur_nodes.teleop.keyboard.teleop_twist_keyboard_node import start as start_keyboard
from ur_nodes.teleop.terminal.keys import decode_keys


def change(node: MemoryNode, name: str, value: object) -> None:
    assert node.parameters.change({f"~{name}": value}) == ""


# -- move_base -------------------------------------------------------------------------------------------------------


@pytest.fixture
def robot() -> RobotStage:
    return RobotStage()


def fastest(robot: RobotStage, seconds: float, axis: int) -> float:
    """The highest velocity that the robot is commanded in a while."""
    got: list[float] = []
    timer = robot.client.every(0.02, lambda: got.append(abs(robot.command[axis])))
    robot.bus.run(seconds)
    timer.cancel()
    return max(got)


def test_max_vel_x_slows_a_drive_that_is_under_way(robot: RobotStage) -> None:
    robot.send(3.0, 0.0)
    assert robot.bus.run_until(lambda: robot.command[0] > 0.4, 20.0)
    change(robot.move_base, "DWAPlannerROS/max_vel_x", 0.1)
    robot.bus.run(1.0)
    assert 0.05 < fastest(robot, 2.0, 0) <= 0.1 + 1e-9
    change(robot.move_base, "DWAPlannerROS/max_vel_x", 0.3)
    assert 0.2 < fastest(robot, 2.0, 0) <= 0.3 + 1e-9


def test_max_vel_theta_slows_a_turn_that_is_under_way(robot: RobotStage) -> None:
    robot.send(0.0, 0.0, yaw=3.0)
    assert robot.bus.run_until(lambda: abs(robot.command[1]) > 0.4, 20.0)
    change(robot.move_base, "DWAPlannerROS/max_vel_theta", 0.2)
    robot.bus.run(0.5)
    assert 0.1 < fastest(robot, 1.0, 1) <= 0.2 + 1e-9


def test_xy_goal_tolerance_gives_a_robot_more_room_at_a_goal_near_a_wall(robot: RobotStage) -> None:
    robot.end(robot.send(-1.27, 0.0))
    before = robot.away(-1.27, 0.0)
    assert before < 0.08
    change(robot.move_base, "DWAPlannerROS/xy_goal_tolerance", 0.4)
    robot.end(robot.send(-1.27, 0.0))
    assert before + 0.02 < robot.away(-1.27, 0.0) < 0.4


def test_yaw_goal_tolerance_ends_a_turn_early(robot: RobotStage) -> None:
    change(robot.move_base, "DWAPlannerROS/yaw_goal_tolerance", 1.0)
    assert robot.end(robot.send(0.0, 0.0, yaw=0.25)) == ("succeeded", "goal reached")
    assert abs(robot.pose.yaw) < 0.05
    change(robot.move_base, "DWAPlannerROS/yaw_goal_tolerance", 0.05)
    robot.end(robot.send(0.0, 0.0, yaw=0.25))
    assert abs(robot.pose.yaw - 0.25) < 0.05


@pytest.mark.parametrize(
    ("name", "value", "grows"), [("inflation_radius", 0.25, False), ("cost_scaling_factor", 5.0, True)]
)
def test_slopes_of_the_global_costmap_change_and_what_was_seen_stays(
    robot: RobotStage, name: str, value: float, grows: bool
) -> None:
    got: list[Map] = []
    robot.client.subscribe("move_base/global_costmap/costmap", Map, got.append, Quality.EVERY)
    robot.occupied[20:25, 10:15] = True  # a box that the map does not show
    robot.bus.run(2.0)
    robot.seeing = False
    change(robot.move_base, f"global_costmap/inflation_layer/{name}", value)
    robot.bus.run(2.0)
    before, after = (each.grid.values.astype(int) for each in (got[0], got[-1]))
    assert bool(np.sum(after[after < 99]) > np.sum(before[before < 99])) is grows
    assert np.sum(after[20:25, 10:15] == 100) > 0


def test_planner_frequency_makes_new_plans_during_a_drive(robot: RobotStage) -> None:
    plans: list[PathValue] = []
    robot.client.subscribe("move_base/NavfnROS/plan", PathValue, plans.append, Quality.EVERY)
    robot.send(3.0, 0.0)
    assert robot.starts_moving()
    before = len(plans)
    robot.bus.run(1.0)
    assert len(plans) - before <= 1
    change(robot.move_base, "planner_frequency", 5.0)
    before = len(plans)
    robot.bus.run(2.0)
    assert len(plans) - before >= 6


def test_default_tolerance_lets_a_path_end_beside_a_goal_that_is_blocked(robot: RobotStage) -> None:
    robot.end(robot.send(-1.4, 0.0))
    assert robot.away(-1.4, 0.0) > 1.0
    change(robot.move_base, "NavfnROS/default_tolerance", 0.5)
    robot.end(robot.send(-1.4, 0.0))
    assert robot.away(-1.4, 0.0) < 0.3


# -- amcl ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "step"), [("update_min_d", (0.1, 0.0)), ("update_min_a", (0.0, 0.1))])
def test_updates_of_amcl_wait_for_more_motion(name: str, step: tuple[float, float]) -> None:
    stage = AmclStage(MAZE)
    stage.drive(3, *step)
    before = len(stage.estimates)
    assert before == 3
    change(stage.node, name, 0.45)
    stage.drive(4, *step)
    assert len(stage.estimates) == before
    stage.drive(1, *step)
    assert len(stage.estimates) == before + 1


@pytest.mark.parametrize(
    ("name", "value"), [("laser_max_range", 0.2), ("laser_min_range", 30.0), ("laser_max_beams", 2)]
)
def test_amcl_knows_less_with_fewer_beams(name: str, value: float) -> None:
    variances = []
    for changed in (False, True):
        stage = AmclStage(MAZE, initial_cov_xx=0.25)
        if changed:
            change(stage.node, name, value)
        stage.drive(6, 0.1, 0.0)
        variances.append(float(stage.estimates[-1].covariance[0, 0]))
    assert variances[1] > 3.0 * variances[0]


# -- slam_gmapping ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "motion"), [("linearUpdate", (0.4, 0.0)), ("angularUpdate", (0.4, 0.4))])
def test_keyframes_come_more_often(name: str, motion: tuple[float, float]) -> None:
    stage = SlamStage(linearUpdate=1.0, angularUpdate=1.5)
    stage.drive(*motion, 1.0)
    before = stage.keyframes()
    change(stage.node, name, 0.1)
    stage.drive(*motion, 2.0)
    assert before == 1
    assert stage.keyframes() >= before + 2


def test_map_update_interval_is_that_of_the_maps() -> None:
    stage = SlamStage(map_update_interval=100.0)
    stage.drive(0.0, 0.2, 1.0)
    before = len(stage.maps)
    change(stage.node, "map_update_interval", 0.5)
    stage.drive(0.0, 0.2, 2.0)
    assert len(stage.maps) >= before + 4


@pytest.mark.parametrize(("name", "value"), [("occ_thresh", 1.0), ("maxRange", 1.0)])
def test_fewer_walls_are_drawn(name: str, value: float) -> None:
    walls = []
    for changed in (False, True):
        stage = SlamStage(map_update_interval=1.0)
        stage.drive(0.0, 0.0, 0.2)
        if changed:
            change(stage.node, name, value)
        stage.drive(0.4, 0.4, 3.0)
        stage.bus.run(1.0)
        walls.append(int(np.sum(stage.maps[-1].grid.values == 100)))
    assert walls[1] < walls[0]


# -- commands --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("name", "axis"), [("speed_lim_v", 0), ("speed_lim_w", 1)])
def test_velocity_smoother_slows_to_a_lower_limit(name: str, axis: int) -> None:
    bus, got = Bus(), list[tuple[float, float]]()
    for limit in ("accel_lim_v", "accel_lim_w", "speed_lim_v", "speed_lim_w"):
        bus.parameters[f"/smoother/{limit}"] = 1.0
    node, client = bus.node("smoother"), bus.node("client")
    start_smoother(node)
    client.subscribe("smoother/smooth_cmd_vel", Twist, lambda twist: got.append((twist.forward, twist.turn)))
    raw = client.publish("smoother/raw_cmd_vel", Twist, Quality.EVERY)
    client.every(0.05, lambda: raw.send(Twist(0.8, 0.8)))
    bus.run(3.0)
    assert got[-1] == (0.8, 0.8)
    change(node, name, 0.3)
    bus.run(1.0)
    assert got[-1][axis] == pytest.approx(0.3)
    assert got[-1][1 - axis] == 0.8


@pytest.mark.parametrize(("name", "key", "axis"), [("speed", b"i", 0), ("turn", b"j", 1), ("speed_limit", b"i", 0)])
def test_keys_drive_at_the_new_speed(name: str, key: bytes, axis: int) -> None:
    bus, got = Bus(), list[tuple[float, float]]()
    bus.parameters |= {"/keys/speed": 0.4, "/keys/turn": 0.4, "/keys/speed_limit": 0.5, "/keys/turn_limit": 0.5}
    bus.node("base").subscribe("cmd_vel", Twist, lambda twist: got.append((twist.forward, twist.turn)), Quality.EVERY)
    node = bus.node("keys")
    driver = start_keyboard(node)
    assert isinstance(driver, PipeDriver)
    driver.press(decode_keys(key)[0])
    assert bus.run_until(lambda: (0.0, 0.0) in got, 5.0)
    assert got[0][axis] == 0.4
    change(node, name, 0.1)
    got.clear()
    driver.press(decode_keys(key)[0])
    assert bus.run_until(lambda: (0.0, 0.0) in got, 5.0)
    assert got[0][axis] == 0.1


@pytest.mark.parametrize(("name", "expected"), [("scale_linear", (0.1, 0.5)), ("scale_angular", (0.5, 0.1))])
def test_joystick_drives_at_the_new_speed(name: str, expected: tuple[float, float]) -> None:
    bus, got = Bus(), list[tuple[float, float]]()
    bus.parameters |= {"/joystick/axis_linear": 1, "/joystick/axis_angular": 0, "/joystick/remote_joy": True}
    node, client = bus.node("joystick"), bus.node("client")
    client.subscribe("cmd_vel", Twist, lambda twist: got.append((twist.forward, twist.turn)))
    start_joystick(node)
    joy = client.publish("joy", Joystick)
    change(node, name, 0.1)
    joy.send(Joystick(client.now(), (1.0, 1.0), (1,)))
    bus.run(0.1)
    assert got == [expected]


def test_speed_limit_of_the_mux_holds_for_what_drives_and_for_the_next_mux(home: Path) -> None:
    robot = MuxRobot(home)
    driver = LeaseDriver(robot.bus, "a")
    driver.wanted = Twist(0.5, 0.0)
    assert max(robot.speeds(1.0)) == pytest.approx(0.5)
    change(robot.mux, "speed_limit_percent", 20.0)
    robot.speeds(1.0)
    assert max(robot.speeds(1.0)) == pytest.approx(0.1)
    robot.kill()
    robot.start()
    assert max(robot.speeds(2.0)) == pytest.approx(0.1)


# -- explore ---------------------------------------------------------------------------------------------------------


def test_small_frontiers_are_left_out() -> None:
    world = ExploreWorld(ROOM)
    change(world.explore, "min_frontier_size", 5.0)
    assert world.run_until("complete").ended
    assert world.goals == []


def test_decisions_of_explore_come_more_often() -> None:
    counts = []
    for rate in (0.1, 5.0):
        world = ExploreWorld(ROOM)
        world.takes = 1000.0
        change(world.explore, "planner_frequency", rate)
        world.bus.run(20.0)
        counts.append(len(world.statuses))
    assert counts[1] > 5 * counts[0]


# -- refusals --------------------------------------------------------------------------------------------------------


def test_speed_above_that_of_the_base_is_refused_and_the_drive_goes_on_as_it_was(robot: RobotStage) -> None:
    refusal = robot.move_base.parameters.change({"~DWAPlannerROS/max_vel_theta": 0.2, "~DWAPlannerROS/max_vel_x": 5.0})
    assert refusal == "parameter /move_base/DWAPlannerROS/max_vel_x: 5.0, expected a number from 0.01 to 0.5"
    robot.send(0.0, 0.0, yaw=3.0)
    assert fastest(robot, 5.0, 1) > 0.4


@pytest.mark.parametrize(
    "name", ["acc_lim_x", "acc_lim_theta"]
)  # the robot could not brake any more as it has planned to
def test_accelerations_of_move_base_are_refused(robot: RobotStage, name: str) -> None:
    refused(robot.move_base, f"DWAPlannerROS/{name}")


@pytest.mark.parametrize("name", ["stop_time", "freshness", "lease_timeout", "obstacle_stop"])  # guards of people
def test_times_of_the_mux_are_refused(home: Path, name: str) -> None:
    refused(MuxRobot(home).mux, name)


def refused(node: MemoryNode, name: str) -> None:
    full = node.resolve(f"~{name}")
    refusal = node.parameters.change({f"~{name}": 0.5})
    assert refusal == f"parameter {full} is read at the start only; set it in the launch file"


def test_name_that_the_node_does_not_read_is_refused(robot: RobotStage) -> None:
    refusal = robot.move_base.parameters.change({"~DWAPlannerROS/max_vel": 0.1})
    assert refusal == "parameter /move_base/DWAPlannerROS/max_vel is not one that the node reads"
