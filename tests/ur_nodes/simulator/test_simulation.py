import math
from collections.abc import Callable

import numpy as np
import pytest

from ur.robot.base import Base
from ur.source.diagnostic import UserError
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.schedule import Schedule, SimulationTick
from ur_nodes.simulator.simulation import Simulation

Drive = Callable[..., None]


@pytest.mark.parametrize("name", ["stage", "magni"])
def test_robot_drives_straight_as_far_as_commanded(
    room: WorldModel, name: str, drive: Drive, request: pytest.FixtureRequest
) -> None:
    base: Base = request.getfixturevalue(name)
    simulation = Simulation(room, base)
    drive(simulation, 1.0)
    drive(simulation, 2.5, 0.4)
    drive(simulation, 1.5)
    x, y, yaw = simulation.pose(0)
    limits = base.limits
    expected = 0.4 * 2.5 - 0.4**2 / 2 * (1 / limits.acceleration - 1 / limits.deceleration)
    assert x == pytest.approx(expected, rel=0.02)
    assert abs(y) < 0.01
    assert abs(yaw) < 0.01


@pytest.mark.parametrize("name", ["stage", "magni"])
def test_robot_turns_on_the_spot(room: WorldModel, name: str, drive: Drive, request: pytest.FixtureRequest) -> None:
    base: Base = request.getfixturevalue(name)
    simulation = Simulation(room, base)
    drive(simulation, math.pi / 2 / 0.8, 0.0, 0.8)
    drive(simulation, 1.5)
    x, y, yaw = simulation.pose(0)
    limits = base.limits
    lost = 0.8**2 / 2 * (1 / limits.angular_acceleration - 1 / limits.angular_deceleration)
    assert yaw == pytest.approx(math.pi / 2 - lost, rel=0.02)
    assert math.hypot(x, y) < 0.02


def test_robot_slips_a_little(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, stage)
    drive(simulation, 3.0, 0.4)
    rolled = sum(simulation.wheel_angles(0)) / 2 * stage.wheels.radius
    slip = 1.0 - simulation.pose(0)[0] / rolled
    assert 1e-5 < slip < 0.01


def test_robot_slips_more_on_a_slippery_floor(
    make_world: Callable[[str], WorldModel], room: WorldModel, stage: Base, drive: Drive
) -> None:
    travelled = []
    for world in (make_world("floor_friction: 0.1\n"), room):
        simulation = Simulation(world, stage)
        drive(simulation, 1.0, 0.5)
        travelled.append(simulation.pose(0)[0])
    assert travelled[0] < 0.9 * travelled[1]


def test_robot_stops_when_commands_cease(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, stage)
    drive(simulation, 1.0, 0.5)
    last = simulation.time
    limit = stage.limits.command_age + 0.5 / stage.limits.deceleration
    while simulation.velocity(0)[0] > 0.01:
        simulation.advance()
        assert simulation.time - last < limit + 0.1
    assert simulation.time - last > stage.limits.command_age


def test_robot_does_not_pass_walls_and_its_wheels_spin(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, stage, start=(4.0, 0.0, 0.0))
    drive(simulation, 6.0, 0.5)
    front = max(x for x, _ in stage.footprint)
    assert simulation.pose(0)[0] + front == pytest.approx(5.0, abs=0.02)
    assert simulation.collisions == (1,)
    assert sum(simulation.wheel_angles(0)) / 2 * stage.wheels.radius > 1.5  # 0.8 to the wall


def test_robot_pushes_obstacles(make_world: Callable[[str], WorldModel], stage: Base, drive: Drive) -> None:
    world = make_world("obstacles:\n  - {name: crate, pose: [0.6, 0, 0], size: [0.3, 0.3, 0.4], mass: 1}\n")
    simulation = Simulation(world, stage)
    ahead = stage.lidar.samples // 2 if stage.lidar else 0
    drive(simulation, 5.0)  # long enough for the physics to put the crate to sleep
    drive(simulation, 2.0, 0.4)
    assert simulation.collisions == (1,)
    assert simulation.pose(0)[0] > 0.5
    assert simulation.scan(0)[ahead] < 0.2  # it is still in front of the robot


@pytest.mark.parametrize("name", ["stage", "magni"])
def test_robot_that_rests_does_not_move_until_it_is_commanded_or_placed(
    room: WorldModel, name: str, drive: Drive, request: pytest.FixtureRequest
) -> None:
    simulation = Simulation(room, request.getfixturevalue(name))
    drive(simulation, 0.5, 0.3, 0.2)
    drive(simulation, 2.0)
    rest, state = simulation.pose(0), simulation.state()
    drive(simulation, 1.0)
    assert np.array_equal(simulation.state(), state)
    drive(simulation, 1.0, 0.3)
    assert math.dist(simulation.pose(0)[:2], rest[:2]) > 0.15
    drive(simulation, 3.0)
    simulation.set_pose("robot", (3.0, 1.0, 0.5))
    drive(simulation, 1.0)
    assert simulation.pose(0) == pytest.approx((3.0, 1.0, 0.5), abs=1e-3)


def test_robot_that_rests_notices_who_runs_into_it(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, stage, robots=2)
    drive(simulation, 2.0)
    drive(simulation, 2.0, -0.4, 0.0, 1)
    assert simulation.collisions == (1, 1)
    assert simulation.pose(0)[0] < -0.001


def test_robot_lidar_sees_other_robots_and_not_itself(room: WorldModel, stage: Base) -> None:
    simulation = Simulation(room, stage, robots=2)
    while "scan" not in simulation.advance().due:
        pass
    lidar = stage.lidar
    assert lidar is not None
    ahead = lidar.samples // 2
    gap = simulation.pose(1)[0] - 0.2 - lidar.pose[0]
    assert simulation.scan(0)[ahead] == pytest.approx(gap, abs=6 * lidar.noise)
    assert simulation.scan(1)[ahead] == pytest.approx(5.0 - simulation.pose(1)[0] - lidar.pose[0], abs=6 * lidar.noise)


def trajectory(simulation: Simulation, seconds: float) -> list[tuple[SimulationTick, tuple[float, ...], list[float]]]:
    """Drive a curve and write everything down, to the last bit."""
    begin = simulation.time
    rows: list[tuple[SimulationTick, tuple[float, ...], list[float]]] = []
    while simulation.time < begin + seconds - 1e-9:
        t = round(simulation.time - begin, 6)
        simulation.command(0, 0.3 + 0.2 * math.sin(t), math.cos(3.0 * t))
        tick = simulation.advance()
        scan = simulation.scan(0).tolist() if "scan" in tick.due else []
        state = (*simulation.pose(0), *simulation.odometry(0).pose, *simulation.velocity(0))
        rows.append((SimulationTick(round(tick.time - begin, 6), tick.due), state, scan))
    return rows


def test_simulation_repeats_itself_to_the_last_bit(room: WorldModel, stage: Base) -> None:
    first = trajectory(Simulation(room, stage, seed=5), 4.0)
    assert trajectory(Simulation(room, stage, seed=5), 4.0) == first


def test_simulation_repeats_itself_after_a_reset(make_world: Callable[[str], WorldModel], stage: Base) -> None:
    world = make_world("obstacles:\n  - {name: crate, pose: [1, 0, 0], size: [0.3, 0.3, 0.4], mass: 1}\n")
    simulation = Simulation(world, stage, seed=5)
    first = trajectory(simulation, 4.0)
    before = simulation.time
    simulation.set_pose("crate", (4.0, 1.0, 0.3))
    simulation.reset()
    assert simulation.time == before
    assert trajectory(simulation, 4.0) == first


def test_simulation_of_another_seed_has_other_noise_but_the_same_physics(room: WorldModel, stage: Base) -> None:
    one, other = trajectory(Simulation(room, stage, seed=1), 1.0), trajectory(Simulation(room, stage, seed=2), 1.0)
    assert [row[1][:3] for row in one] == [row[1][:3] for row in other]
    assert one[-1][1][3:6] != other[-1][1][3:6]


def test_simulation_does_not_depend_on_who_looks_at_scans(room: WorldModel, stage: Base) -> None:
    watched, alone = Simulation(room, stage), Simulation(room, stage)
    for _ in range(200):
        if "scan" in watched.advance().due:
            watched.scan(0)
        alone.advance()
    assert watched.scan(0).tolist() == alone.scan(0).tolist()


def test_simulation_keeps_the_rates_of_the_base(room: WorldModel, magni: Base) -> None:
    simulation = Simulation(room, magni)
    ticks = []
    while simulation.time < 5.0 - 1e-9:
        ticks.append(simulation.advance())
    assert magni.lidar is not None
    assert sum("odometry" in tick.due for tick in ticks) == round(5.0 * magni.odometry.rate)
    assert sum("scan" in tick.due for tick in ticks) == round(5.0 * magni.lidar.rate)


def test_place_moves_a_robot_at_rest_without_its_odometry(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, stage)
    drive(simulation, 1.0, 0.5)
    before = simulation.odometry(0).pose
    simulation.set_pose("robot", (3.0, 1.0, 2.0))
    assert simulation.pose(0) == pytest.approx((3.0, 1.0, 2.0))
    simulation.advance()
    assert math.hypot(*simulation.velocity(0)) < 0.05
    assert simulation.odometry(0).pose == pytest.approx(before, abs=0.05)


@pytest.mark.parametrize(
    ("name", "pose", "message"),
    [
        ("robot", (-0.9, 0.0, 0.0), r"robot_0 cannot be at x -0.9, y 0: a wall, expected free floor"),
        ("robot", (20.0, 0.0, 0.0), r"outside the floor plan"),
        ("robot", (2.0, 0.0, 0.0), r"robot_0 cannot be at x 2, y 0: crate"),
        ("crate", (0.1, 0.0, 0.0), r"crate cannot be at x 0.1, y 0: robot_0"),
        ("craet", (1.0, 0.0, 0.0), r"'craet' cannot be placed, expected one of robot_0, crate"),
        ("robot", (math.nan, 0.0, 0.0), r"expected finite numbers"),
    ],
)
def test_place_refuses_what_is_not_free_and_changes_nothing(
    make_world: Callable[[str], WorldModel], stage: Base, name: str, pose: tuple[float, float, float], message: str
) -> None:
    world = make_world("obstacles:\n  - {name: crate, pose: [2, 0, 0], size: [0.3, 0.3, 0.4], mass: 1}\n")
    simulation, untouched = Simulation(world, stage), Simulation(world, stage)
    with pytest.raises(UserError, match=message):
        simulation.set_pose(name, pose)
    assert trajectory(simulation, 1.0) == trajectory(untouched, 1.0)


def test_place_puts_an_obstacle_where_the_lidar_sees_it(make_world: Callable[[str], WorldModel], stage: Base) -> None:
    world = make_world("obstacles:\n  - {name: crate, pose: [-4, 0, 0], size: [0.3, 0.3, 0.6], mass: 20}\n")
    simulation = Simulation(world, stage)
    for _ in range(300):  # long enough for the obstacle to have come to rest
        simulation.advance()
    assert stage.lidar is not None
    ahead = stage.lidar.samples // 2
    assert simulation.scan(0)[ahead] == pytest.approx(4.9, abs=0.1)
    simulation.set_pose("crate", (2.0, 0.0, 0.0))
    assert simulation.scan(0)[ahead] == pytest.approx(2.0 - 0.15 - 0.1, abs=0.06)
    for _ in range(300):
        simulation.advance()
    assert simulation.scan(0)[ahead] == pytest.approx(2.0 - 0.15 - 0.1, abs=0.06)


def test_simulation_refuses_to_start_in_a_wall(room: WorldModel, stage: Base) -> None:
    with pytest.raises(UserError, match="a wall"):
        Simulation(room, stage, start=(5.0, 0.0, 0.0))


def test_collisions_count_a_scrape_once_and_a_second_bump_again(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, stage, start=(4.5, 0.0, 0.0))
    drive(simulation, 3.0, 0.4)
    assert simulation.collisions == (1,)
    drive(simulation, 1.5, -0.3)
    drive(simulation, 3.0, 0.4)
    assert simulation.collisions == (2,)


def test_schedule_does_not_drift() -> None:
    schedule = Schedule(30.0)
    taken = [step for step in range(1, 6001) if schedule.consume(step)]
    assert len(taken) == 900
    assert taken[-1] == 6000
    assert set(np.diff(taken)) <= {6, 7}
