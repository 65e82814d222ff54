"""Mux, base and physics in lock step: a robot stands within 0.3 s of the last command, at any phase of anything."""

import math
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from ur.robot.base import BRAKE_AFTER, Base, list_bases, load_base
from ur.worlds.map_file import MapFile, MapImage
from ur.worlds.world_file import WorldModel, read_world
from ur_nodes.motion.mux import start_mux, step
from ur_nodes.motion.mux_events import MuxSettings, Source, Velocity, VelocityCommand
from ur_nodes.motion.mux_settings import slow_to_sight
from ur_nodes.motion.ramp import axes_of
from ur_nodes.simulator.simulation import Simulation

PACKAGE = Path(__file__).resolve().parents[3] / "ubiquity_launches"
MESSAGE = 0.005  # s: what a message may take
PERIOD = 0.05  # s: of a commander at 20 Hz
DIRECTIONS = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (1.0, -1.0), (-1.0, 0.5))


@pytest.fixture(scope="module")
def maze() -> WorldModel:
    return read_world(PACKAGE / "n_simulator" / "worlds" / "maze.yaml")


@pytest.fixture(scope="module")
def hall() -> WorldModel:
    """A floor of 40 m by 40 m without walls."""
    file = MapFile(
        Path("none.png"), 0.5, (-20.0, -20.0, 0.0), negate=False, occupied_thresh=0.65, free_thresh=0.2, mode="trinary"
    )
    return WorldModel(MapImage(file, np.zeros((80, 80), np.int8)), 1.0, 0.9, (), (), (0.0, 0.0, 0.0))


@dataclass(frozen=True)
class Moment:
    """A base at a time (s) after the last command: its speeds (m/s, rad/s), and where it is (m)."""

    time: float
    speed: float
    spin: float
    at: tuple[float, float]


def let_go(
    world: WorldModel, base: Base, direction: tuple[float, float], phase: float, seconds: float = 1.2
) -> list[Moment]:
    """Command full speed at a phase (s) of the mux's clock for some time, then nothing more."""
    wish = Velocity(direction[0] * base.limits.velocity, direction[1] * base.limits.angular_velocity)
    forward, turn = axes_of(base.limits)
    after = BRAKE_AFTER if base.limits.fast else None
    mux = start_mux(MuxSettings((Source("keyboard", "key_vel", 90, 0.15),), forward, turn, brake_after=after))
    simulation = Simulation(world, base, start=(2.0, 0.0, 0.0))
    sent = [phase + n * PERIOD for n in range(round(seconds / PERIOD))]
    arrivals = [at + MESSAGE for at in sent]
    on_the_way: list[tuple[float, Velocity]] = []
    moments = []
    while simulation.time < sent[-1] + 0.8 + base.limits.velocity / base.limits.deceleration:
        until = simulation.next_time
        while (due := min([mux.next_at, *arrivals[:1]])) <= until:
            event = VelocityCommand(0, wish) if arrivals and due == arrivals[0] else None
            arrivals = arrivals[1:] if event else arrivals
            mux, output = step(mux, event, due)
            if output is not None:
                on_the_way.append((due + MESSAGE, output))
        while on_the_way and on_the_way[0][0] <= until:
            _, velocity = on_the_way.pop(0)
            simulation.command(0, velocity.forward, velocity.turn)
        simulation.advance()
        speed, _, spin = simulation.velocity(0)
        x, y, _ = simulation.pose(0)
        moments.append(Moment(simulation.time - sent[-1], speed, spin, (x, y)))
    before = [each for each in moments if each.time < 0.0]
    reached = max(
        max(abs(each.speed) / base.limits.velocity, abs(each.spin) / base.limits.angular_velocity) for each in before
    )
    assert reached > 0.95, "it was to be at full speed"
    return moments


def moves(moment: Moment) -> bool:
    return abs(moment.speed) >= 0.01 or abs(moment.spin) >= 0.02


def stop_time(world: WorldModel, base: Base, direction: tuple[float, float], phase: float) -> float:
    """How long the robot moves after the last of the commands (s)."""
    moments = let_go(world, base, direction, phase)
    return max(after.time for before, after in pairwise(moments) if moves(before))


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("name", list_bases(PACKAGE))
def test_robot_stands_in_time_when_commands_cease(maze: WorldModel, name: str, direction: tuple[float, float]) -> None:
    base = load_base(PACKAGE, name)
    base = replace(base, lidar=None, odometry=replace(base.odometry, rate=100.0))  # to look every 10 ms
    assert max(stop_time(maze, base, direction, phase) for phase in (0.0, 0.003, 0.007, 0.012, 0.017)) <= 0.3


@pytest.mark.parametrize("speed", [1.0, 2.0, 3.0])
@pytest.mark.parametrize("braking", [1.5, 4.0])
def test_fast_base_brakes_in_time_and_rests_within_its_way(hall: WorldModel, speed: float, braking: float) -> None:
    base = load_base(PACKAGE, "stage")
    limits = replace(base.limits, velocity=speed, acceleration=braking, deceleration=braking)
    base = replace(base, lidar=None, odometry=replace(base.odometry, rate=100.0), limits=limits)
    assert limits.fast
    for phase in (0.0, 0.007, 0.012, 0.017):
        moments = let_go(hall, base, (1.0, 0.0), phase, seconds=1.0 + speed / braking)
        last = [each for each in moments if each.time <= 0.0][-1]
        brakes = next(each.time for each in moments if each.time > 0.0 and each.speed < 0.985 * speed)
        assert brakes <= BRAKE_AFTER + 0.02
        rest = next(each for each in moments if each.time > 0.0 and not moves(each))
        assert math.dist(last.at, rest.at) <= 1.05 * limits.way_to_rest
        hardest = max((before.speed - after.speed) / (after.time - before.time) for before, after in pairwise(moments))
        assert hardest <= 1.5 * braking


@pytest.mark.parametrize(("variant", "eyes"), [("", "sonars"), ("lidar", "lidar")])
def test_fast_base_is_slowed_to_what_its_lidar_sees_or_its_sonars_without_one(variant: str, eyes: str) -> None:
    base = load_base(PACKAGE, "magni", variant)
    base = replace(base, limits=replace(base.limits, velocity=3.0, deceleration=2.0))
    assert base.sonars
    base = replace(base, sonars=replace(base.sonars, range_max=2.35))
    if base.lidar:
        base = replace(base, lidar=replace(base.lidar, range_max=1.35))
    slowed, line = slow_to_sight(base)
    sight = 1.0 if base.lidar else 2.0
    assert slowed.limits.way_to_rest == pytest.approx(sight, abs=0.01)
    assert line.endswith(
        f"from 3 m/s it rests within 2.9 m, and its {eyes} {'sees' if base.lidar else 'see'} {sight:.1f} m"
    )


def test_base_without_a_sensor_in_use_keeps_its_speed() -> None:
    base = load_base(PACKAGE, "magni")
    base = replace(base, limits=replace(base.limits, velocity=3.0, deceleration=0.5))
    assert slow_to_sight(base, sonars=False) == (base, "")
    assert slow_to_sight(base)[0].limits.velocity < 2.0
