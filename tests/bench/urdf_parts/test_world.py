import os

import pytest
from bench.urdf_parts.world import choose_world, world_for


def rectangle(length: float, width: float, ahead: float = 0.0) -> tuple[tuple[float, float], ...]:
    front, back, side = length / 2 + ahead, -length / 2 + ahead, width / 2
    return ((front, side), (back, side), (back, -side), (front, -side))


@pytest.mark.parametrize(
    ("outline", "world"),
    [
        (rectangle(0.2, 0.2), "maze"),
        (rectangle(0.72, 0.54), "maze"),  # its corners are 0.45 m away
        (rectangle(0.74, 0.54), "office"),
        (rectangle(0.60, 0.40), "maze"),
        (rectangle(0.60, 0.40, ahead=0.2), "office"),  # the same one turns about a point farther back
    ],
)
def test_base_whose_farthest_corner_does_not_turn_in_a_door_gets_the_office(
    outline: tuple[tuple[float, float], ...], world: str
) -> None:
    assert world_for(outline) == world


def test_base_of_the_library_is_found_by_name() -> None:
    assert choose_world("stage", os.environ) == "maze"
