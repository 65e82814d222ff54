"""A base whose wheels roll to all sides, in the simulator, beside one that drives ahead and turns only."""

import dataclasses
import math
from pathlib import Path

import pytest
import yaml
from tests.base_contract import PACKAGE, load
from tests.ur_nodes.first_drive.stage import DrivenStage

from ur.robot.base import Base
from ur.worlds.world_file import WorldModel
from ur_nodes.localisation.amcl_node import AmclNode
from ur_nodes.ports.values import Odometry, PoseEstimate, Twist
from ur_nodes.simulator.mujoco_model import build_model
from ur_nodes.simulator.simulation import Simulation


@pytest.fixture(scope="module")
def omni() -> Base:
    stage = load("stage", "")
    return dataclasses.replace(stage, limits=dataclasses.replace(stage.limits, lateral_velocity=0.4))


def drive(simulation: Simulation, seconds: float, linear: float = 0.0, angular: float = 0.0, left: float = 0.0) -> None:
    end = simulation.time + seconds - 1e-9
    while simulation.time < end:
        simulation.command(0, linear, angular, left)
        simulation.advance()


def test_omni_base_drives_to_its_left_as_fast_as_commanded(room: WorldModel, omni: Base) -> None:
    simulation = Simulation(room, omni)
    drive(simulation, 5.0)
    drive(simulation, 2.0, left=0.3)
    assert simulation.velocity(0) == pytest.approx((0.0, 0.3, 0.0), abs=0.003)
    drive(simulation, 0.5)
    limits = omni.limits
    expected = 0.3 * 2.0 - 0.3**2 / 2 * (1 / limits.acceleration - 1 / limits.deceleration)
    assert simulation.pose(0) == pytest.approx((0.0, expected, 0.0), abs=0.01)
    assert simulation.wheel_angles(0) == pytest.approx((0.0, 0.0), abs=0.01)


def test_omni_base_keeps_its_limits_to_the_side(room: WorldModel, omni: Base) -> None:
    simulation = Simulation(room, omni)
    before = 0.0
    while simulation.time < 1.0:
        simulation.command(0, 0.0, 0.0, -3.0)
        simulation.advance()
        now = simulation.velocity(0)[1]
        assert before - now <= omni.limits.acceleration * 0.02 * 1.5 + 0.002
        before = now
    assert before == pytest.approx(-0.4, abs=0.003)


def test_omni_base_moves_along_all_three_axes_at_once(room: WorldModel, omni: Base) -> None:
    simulation = Simulation(room, omni)
    drive(simulation, 1.5, linear=0.2, angular=0.5, left=-0.3)
    assert simulation.velocity(0) == pytest.approx((0.2, -0.3, 0.5), abs=0.01)
    rims = [angle * omni.wheels.radius for angle in simulation.wheel_angles(0)]
    assert (rims[1] - rims[0]) / omni.wheels.separation == pytest.approx(simulation.pose(0).yaw, abs=0.02)


def test_omni_base_stops_when_commands_cease(room: WorldModel, omni: Base) -> None:
    simulation = Simulation(room, omni)
    drive(simulation, 1.0, left=0.4)
    last = simulation.time
    limit = omni.limits.command_age + 0.4 / omni.limits.deceleration
    while simulation.velocity(0)[1] > 0.01:
        simulation.advance()
        assert simulation.time - last < limit + 0.1
    assert simulation.time - last > omni.limits.command_age


def test_wall_stops_an_omni_base_whose_wheels_slip(room: WorldModel, omni: Base) -> None:
    simulation = Simulation(room, omni)
    drive(simulation, 8.0, left=0.4)
    side = max(y for _, y in omni.footprint)
    assert simulation.pose(0)[1] + side == pytest.approx(2.0, abs=0.02)
    assert simulation.collisions == (1,)
    assert simulation.odometry(0).pose[1] > 2.5
    assert math.hypot(*simulation.velocity(0)[:2]) < 0.01


def test_omni_base_slips_on_a_slippery_floor(room: WorldModel, omni: Base) -> None:
    simulation = Simulation(dataclasses.replace(room, floor_friction=0.05), omni)
    drive(simulation, 1.0, left=0.4)
    assert 0.0 < simulation.pose(0)[1] < 0.9 * simulation.odometry(0).pose[1]


def test_place_and_reset_stop_an_omni_base(room: WorldModel, omni: Base) -> None:
    simulation = Simulation(room, omni, seed=3)
    drive(simulation, 1.0, left=0.4)
    first = simulation.pose(0), simulation.odometry(0).pose
    simulation.set_pose("robot", (1.0, 0.0, 0.0))
    drive(simulation, 0.5)
    assert simulation.pose(0) == pytest.approx((1.0, 0.0, 0.0), abs=1e-3)
    assert simulation.odometry(0).pose == pytest.approx(first[1], abs=0.02)
    simulation.reset()
    drive(simulation, 1.0, left=0.4)
    assert (simulation.pose(0), simulation.odometry(0).pose) == first


def test_base_with_two_driven_wheels_ignores_a_command_to_the_left(room: WorldModel, omni: Base) -> None:
    limits = dataclasses.replace(omni.limits, lateral_velocity=0.0)
    wheeled = dataclasses.replace(omni, limits=limits)
    commanded, plain = Simulation(room, wheeled, seed=2), Simulation(room, wheeled, seed=2)
    drive(commanded, 1.0, linear=0.3, angular=0.2, left=0.4)
    drive(plain, 1.0, linear=0.3, angular=0.2)
    assert commanded.pose(0) == plain.pose(0)
    assert commanded.odometry(0).pose == plain.odometry(0).pose
    assert "aside" not in build_model(room, wheeled, 1, room.start)


@pytest.fixture
def own_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A package with the base `omni`."""
    text = (PACKAGE / "bases" / "stage" / "base.yaml").read_text(encoding="utf-8")
    folder = tmp_path / "share" / "ubiquity_launches" / "bases" / "omni"
    folder.mkdir(parents=True)
    (tmp_path / ".catkin").touch()
    aside = text.replace("command_age:", "lateral_velocity: 0.4, command_age:", 1)
    (folder / "base.yaml").write_text(aside, encoding="utf-8")
    monkeypatch.setenv("CMAKE_PREFIX_PATH", str(tmp_path))


@pytest.mark.usefixtures("own_package")
@pytest.mark.parametrize("command", [(0.0, 0.0, 0.4), (0.2, 0.0, 0.3)], ids=["to the side", "askew"])
def test_omni_base_that_presses_a_wall_knows_where_it_is_to_five_centimetres(
    command: tuple[float, float, float],
) -> None:
    stage = DrivenStage("maze", base="omni", seed=1)
    stage.serve_map()
    estimates, odometry = stage.record("amcl_pose", PoseEstimate), stage.record("odom", Odometry)
    lost, contacts = stage.record("amcl/lost", str), stage.record("simulator/collisions", int)
    settings = yaml.safe_load((PACKAGE / "n_amcl" / "params" / "stage.yaml").read_text(encoding="utf-8"))
    stage.add("amcl", AmclNode, **settings | {"odom_model_type": "omni-corrected", "odom_alpha5": 0.02})
    stage.bus.run(1.0)
    commands = stage.client.publish("cmd_vel", Twist)
    for _ in range(160):
        commands.send(Twist(*command))
        stage.bus.run(0.05)
    stage.bus.run(1.0)
    true = stage.truth.pose
    assert contacts
    assert math.dist(odometry[-1].pose[:2], true[:2]) > 1.0
    assert math.dist(estimates[-1].pose[:2], true[:2]) < 0.05
    assert not any(lost)


@pytest.mark.usefixtures("own_package")
def test_node_takes_commands_to_the_left_and_reports_motion_there() -> None:
    for base, speed, variance in (("omni", 0.3, 1e-4), ("stage", 0.0, 1e-6)):
        stage = DrivenStage(base=base)
        odometry, commands = stage.record("odom", Odometry), stage.client.publish("cmd_vel", Twist)
        for _ in range(20):
            commands.send(Twist(0.0, 0.0, 0.3))
            stage.bus.run(0.05)
        assert odometry[-1].twist.left == pytest.approx(speed, abs=0.04)
        assert stage.truths[-1].twist.left == pytest.approx(speed, abs=0.01)
        assert odometry[-1].twist_covariance[1, 1] == variance
