"""Mux, base and physics in lock step: a robot stands within 0.3 s of the last command, at any phase of anything."""

from dataclasses import replace
from pathlib import Path

import pytest

from ur.robot.base import Base, list_bases, load_base
from ur.worlds.world_file import WorldModel, read_world
from ur_nodes.motion.mux import start_mux, step
from ur_nodes.motion.mux_events import MuxSettings, Source, Velocity, VelocityCommand
from ur_nodes.motion.ramp import axes_of
from ur_nodes.simulator.simulation import Simulation

PACKAGE = Path(__file__).resolve().parents[3] / "ubiquity_launches"
MESSAGE = 0.005  # s: what a message may take
PERIOD = 0.05  # s: of a commander at 20 Hz
DIRECTIONS = ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (1.0, -1.0), (-1.0, 0.5))


@pytest.fixture(scope="module")
def maze() -> WorldModel:
    return read_world(PACKAGE / "n_simulator" / "worlds" / "maze.yaml")


def stop_time(world: WorldModel, base: Base, direction: tuple[float, float], phase: float) -> float:
    """How long the robot moves after the last of the commands (s): at full speed, sent at a phase (s) of its clock."""
    wish = Velocity(direction[0] * base.limits.velocity, direction[1] * base.limits.angular_velocity)
    forward, turn = axes_of(base.limits)
    mux = start_mux(MuxSettings((Source("keyboard", "key_vel", 90, 0.15),), forward, turn))
    simulation = Simulation(world, base, start=(2.0, 0.0, 0.0))
    sent = [phase + n * PERIOD for n in range(24)]
    arrivals = [at + MESSAGE for at in sent]
    on_the_way: list[tuple[float, Velocity]] = []
    moved_at, fastest = 0.0, 0.0
    while simulation.time < sent[-1] + 0.8:
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
        if simulation.time < sent[-1]:
            fastest = max(abs(speed) / base.limits.velocity, abs(spin) / base.limits.angular_velocity)
        if abs(speed) >= 0.01 or abs(spin) >= 0.02:
            moved_at = simulation.next_time
    assert fastest > 0.95, "it was to be at full speed"
    return moved_at - sent[-1]


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("name", list_bases(PACKAGE))
def test_robot_stands_in_time_when_commands_cease(maze: WorldModel, name: str, direction: tuple[float, float]) -> None:
    base = load_base(PACKAGE, name)
    base = replace(base, lidar=None, odometry=replace(base.odometry, rate=100.0))  # to look every 10 ms
    assert max(stop_time(maze, base, direction, phase) for phase in (0.0, 0.003, 0.007, 0.012, 0.017)) <= 0.3
