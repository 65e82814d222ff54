import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur.robot.base import Base, Bumper, Bumpers
from ur.worlds.world_file import WorldModel
from ur_nodes.simulator.sensors.bumpers import HOLD, BumperRing, BumperSense, arcs_meet, span_arc
from ur_nodes.simulator.simulation import Simulation

RING = Bumpers(
    "bumper",
    (
        Bumper("front_left", 0.0, 1.2),
        Bumper("front_right", -1.2, 0.0),
        Bumper("back", 2.0, 2.0 * math.pi - 2.0),
    ),
)
Drive = Callable[..., None]
angle = st.integers(-3141, 3141).map(lambda mrad: mrad / 1000.0)
length = st.integers(0, 6283).map(lambda mrad: mrad / 1000.0)
part = st.integers(-1000, 1000).map(lambda mm: mm / 1000.0)


def pressed(simulation: Simulation) -> set[str]:
    return {name for name, closed in simulation.senses[0].find(BumperSense).pressed(simulation.time).items() if closed}


def test_nothing_is_pressed_by_the_floor(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, replace(stage, bumpers=RING))
    drive(simulation, 1.0, 0.3)
    assert simulation.senses[0].find(BumperSense).pressed(simulation.time) == {
        "front_left": False,
        "front_right": False,
        "back": False,
    }


def test_wall_ahead_presses_both_halves_of_the_front_and_lets_go(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, replace(stage, bumpers=RING), start=(4.6, 0.0, 0.0))
    drive(simulation, 2.5, 0.3)
    assert pressed(simulation) == {"front_left", "front_right"}
    drive(simulation, 2.0, -0.3)
    assert pressed(simulation) == set()


def test_wall_behind_presses_the_back(room: WorldModel, stage: Base, drive: Drive) -> None:
    simulation = Simulation(room, replace(stage, bumpers=RING), start=(-0.6, 0.0, 0.0))
    drive(simulation, 2.0, -0.3)
    assert pressed(simulation) == {"back"}


@pytest.mark.parametrize(("side", "name"), [(1.0, "front_left"), (-1.0, "front_right")])
def test_corner_presses_its_side_only(room: WorldModel, stage: Base, drive: Drive, side: float, name: str) -> None:
    simulation = Simulation(room, replace(stage, bumpers=RING), start=(0.0, 1.55 * side, 0.5 * side))
    seen: set[str] = set()
    while not seen and simulation.time < 5.0:
        drive(simulation, 0.02, 0.3)
        seen = pressed(simulation)
    assert seen == {name}


def test_bumper_stays_pressed_while_contacts_flicker() -> None:
    ring = BumperRing(RING)
    ring.press([np.array([[0.2, 0.05]])], 1.0)
    assert ring.state(1.0 + HOLD / 2)["front_left"]
    assert not ring.state(1.0 + HOLD * 1.1)["front_left"]


@given(st.lists(angle, min_size=1, max_size=6), angle)
def test_arc_holds_all_angles_is_shortest_and_turns_with_them(angles: list[float], turn: float) -> None:
    begin, end = span_arc(np.array(angles))
    size = end - begin
    assert 0.0 <= size < 2.0 * math.pi
    for each in angles:
        assert (each - begin + 1e-9) % (2.0 * math.pi) <= size + 2e-9
    turned = span_arc(np.array(angles) + turn)
    assert turned[1] - turned[0] == pytest.approx(size, abs=1e-9)


@given(angle, length, angle, length)
def test_arcs_meet_where_either_begins_in_the_other(a: float, la: float, b: float, lb: float) -> None:
    one, other = (a, a + la), (b, b + lb)
    assert arcs_meet(one, other) == arcs_meet(other, one)
    assert arcs_meet(one, one)
    steps = np.linspace(0.0, 1.0, 2000)
    shared = ((a + la * steps - b) % (2.0 * math.pi) <= lb).any() or (
        (b + lb * steps - a) % (2.0 * math.pi) <= la
    ).any()
    assert arcs_meet(one, other) == shared


@given(part, part.filter(bool))
def test_single_point_presses_what_the_base_says_it_covers(x: float, y: float) -> None:
    ring = BumperRing(RING)
    ring.press([np.array([[x, y]])], 0.0)
    assert ring.state(0.0) == {bumper.name: bumper.covers(x, y) for bumper in RING.at}
