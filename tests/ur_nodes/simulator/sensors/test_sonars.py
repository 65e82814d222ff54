import math
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.ur_nodes.simulator.conftest import MakeWorld

from ur.robot.base import Base, Sonar, Sonars
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.sensors.sonars import SonarRing, SonarSense, cone_rays
from ur_nodes.simulator.simulation import Simulation

VIEW = 0.4363


def cm(first: int, last: int) -> st.SearchStrategy[float]:
    """Lengths in m, in whole cm."""
    return st.integers(first, last).map(lambda whole: whole / 100.0)


def fit(base: Base, *poses: tuple[float, ...], noise: float = 0.0, range_max: float = 3.0) -> Base:
    """A base with sonars at some poses."""
    at = tuple(Sonar(f"sonar_{number}", pose) for number, pose in enumerate(poses))
    return replace(base, sonars=Sonars("sonars", 10.0, VIEW, 0.05, range_max, noise, at))


def hear(simulation: Simulation) -> list[float]:
    """What the sonars say when they are next due."""
    while "sonars" not in simulation.advance().due:
        pass
    return [float(each) for each in simulation.senses[0].find(SonarSense).ranges()]


AHEAD = (0.2, 0.0, 0.15, 0.0, 0.0, 0.0)


def test_sonar_gives_the_distance_to_the_wall_it_faces(room: WorldModel, stage: Base) -> None:
    left, back = (0.0, 0.2, 0.15, 0.0, 0.0, math.pi / 2), (-0.2, 0.0, 0.15, 0.0, 0.0, math.pi)
    simulation = Simulation(room, fit(stage, AHEAD, left, back), start=(3.0, 0.5, 0.0))
    assert hear(simulation) == pytest.approx([5.0 - 3.2, 2.0 - 0.7, math.inf], abs=0.005)
    simulation.set_pose("robot", (3.0, 0.5, math.pi / 2))
    assert hear(simulation) == pytest.approx([1.3, math.inf, 2.3], abs=0.005)


@pytest.mark.parametrize("off", [0.0, 0.1, -0.2, 0.218])
def test_sonar_hears_the_nearest_point_of_a_wall_that_it_faces_at_an_angle(
    room: WorldModel, stage: Base, off: float
) -> None:
    simulation = Simulation(room, fit(stage, (0.0, 0.0, 0.15, 0.0, 0.0, off)), start=(3.0, 0.0, 0.0))
    assert hear(simulation)[0] == pytest.approx(2.0, rel=0.003)  # the foot of the perpendicular is in the cone


def test_sonar_hears_an_obstacle_that_moves_in_and_out_of_its_cone(make_world: MakeWorld, stage: Base) -> None:
    world = make_world("obstacles:\n  - {name: crate, pose: [-4, 0, 0], size: [0.3, 0.3, 0.6], mass: 20}\n")
    simulation = Simulation(world, fit(stage, AHEAD, range_max=2.0))
    assert hear(simulation) == [math.inf]
    simulation.set_pose("crate", (1.5, 0.0, 0.0))
    assert hear(simulation)[0] == pytest.approx(1.5 - 0.15 - 0.2, abs=0.005)
    simulation.set_pose("crate", (1.5, 0.3, 0.0))  # its corner is still in the cone
    assert 1.1 < hear(simulation)[0] < 1.3
    simulation.set_pose("crate", (1.5, 0.8, 0.0))
    assert hear(simulation) == [math.inf]


def test_sonar_hears_a_table_top_above_its_axis(make_world: MakeWorld, stage: Base) -> None:
    world = make_world("boxes:\n  - {name: table, pose: [2.2, 0.0, 0.5, 0.0], size: [1.0, 1.0, 0.04]}\n")
    simulation = Simulation(world, fit(stage, AHEAD))
    assert 1.5 < hear(simulation)[0] < 2.2


def test_sonar_does_not_hear_its_own_robot_but_another_one(room: WorldModel, stage: Base) -> None:
    simulation = Simulation(room, fit(stage, (0.0, 0.0, 0.15, 0.0, 0.0, 0.0)), robots=2)
    gap = simulation.pose(1)[0] - 0.2
    assert hear(simulation)[0] == pytest.approx(gap, abs=0.01)


def test_sonar_says_what_is_too_near_and_too_far_after_rep_117(room: WorldModel, stage: Base) -> None:
    near = (4.98 - 4.5, 0.0, 0.15, 0.0, 0.0, 0.0)
    simulation = Simulation(room, fit(stage, near, AHEAD, range_max=0.2), start=(4.5, 0.0, 0.0))
    assert hear(simulation) == [-math.inf, math.inf]


def test_sonar_noise_has_the_deviation_of_the_base_and_follows_the_seed(room: WorldModel, stage: Base) -> None:
    def run(seed: int) -> list[float]:
        simulation = Simulation(room, fit(stage, AHEAD, noise=0.02), seed=seed, start=(3.0, 0.0, 0.0))
        return [hear(simulation)[0] for _ in range(300)]

    one = run(1)
    assert one == run(1)
    assert one != run(2)
    assert np.std(one) == pytest.approx(0.02, rel=0.2)
    assert np.mean(one) == pytest.approx(1.8, abs=0.005)


def test_sonars_do_not_change_what_the_lidar_says(room: WorldModel, stage: Base) -> None:
    scans = []
    for base in (stage, fit(stage, AHEAD, noise=0.02)):
        simulation = Simulation(room, base, seed=3)
        while "scan" not in simulation.advance().due:
            pass
        scans.append(simulation.scan(0).tolist())
    assert scans[0] == scans[1]


@given(view=st.floats(0.05, 1.5))
def test_rays_fill_the_cone_and_stay_in_it(view: float) -> None:
    rays = cone_rays(view)
    assert np.allclose(np.linalg.norm(rays, axis=1), 1.0)
    off = np.arccos(np.clip(rays[:, 0], -1.0, 1.0))
    assert off.max() <= view / 2 + 1e-6
    # No direction of the cone is far from a ray.
    polar, turn = np.meshgrid(np.linspace(0.0, view / 2, 12), np.linspace(0.0, 2 * math.pi, 36))
    probes = np.stack([np.cos(polar), np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn)], axis=-1)
    nearest = np.arccos(np.clip(probes.reshape(-1, 3) @ rays.T, -1.0, 1.0)).min(axis=1)
    assert nearest.max() < 0.2 * view


@given(boxes=st.lists(st.tuples(cm(30, 250), cm(-80, 80), cm(-50, 50), cm(5, 40)), max_size=5))
def test_range_is_never_less_than_the_nearest_surface_of_the_cone_nor_more_than_straight_ahead(
    boxes: list[tuple[float, float, float, float]],
) -> None:
    shapes = "".join(
        f'<geom type="box" pos="{x} {y} {z}" size="{half} {half} {half}" group="0"/>' for x, y, z, half in boxes
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody>{shapes}<body name="robot_0"><geom size="0.01"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    sonars = Sonars("sonars", 10.0, VIEW, 0.0, 4.0, 0.0, (Sonar("sonar_0", (0.0,) * 6),))
    heard = float(SonarRing(model, sonars, 0).listen(data, np.zeros(1))[0])
    distances = [distance_of_cone(VIEW / 2, *box) for box in boxes]
    assert heard >= min(distances, default=math.inf) - 1e-6
    hit = np.zeros(1, np.int32)
    straight = mujoco.mj_ray(model, data, np.zeros(3), np.array([1.0, 0.0, 0.0]), None, 1, 1, hit, None)
    if 0.0 <= straight <= 4.0:
        assert heard <= straight + 1e-6


def distance_of_cone(half_angle: float, x: float, y: float, z: float, half: float) -> float:
    """The distance of a box from the apex of the cone if it may touch the cone, else inf: a lower bound."""
    size = half * math.sqrt(3.0)
    distance = math.sqrt(x * x + y * y + z * z)
    if distance <= size:
        return 0.0
    if math.acos(x / distance) - math.asin(size / distance) > half_angle:
        return math.inf
    nearest = [max(abs(each) - half, 0.0) for each in (x, y, z)]
    return math.sqrt(sum(each * each for each in nearest))
