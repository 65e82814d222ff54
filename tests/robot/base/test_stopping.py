"""How a base stops: its way to rest, and the speed at which it rests within what it sees."""

import dataclasses

import pytest
from tests.base_contract import load

from ur.robot.base import MotionLimits, list_bases
from ur.source.project import launch_library


def fast(velocity: float, deceleration: float) -> MotionLimits:
    return dataclasses.replace(load("stage", "").limits, velocity=velocity, deceleration=deceleration)


def test_no_base_of_the_library_needs_longer_than_its_promise() -> None:
    assert not [name for name in list_bases(launch_library()) if load(name, "").limits.fast]


@pytest.mark.parametrize(("velocity", "deceleration", "way"), [(1.0, 2.0, 0.45), (2.0, 2.0, 1.4), (3.0, 4.0, 1.725)])
def test_way_to_rest_is_that_of_the_page_about_safety(velocity: float, deceleration: float, way: float) -> None:
    limits = fast(velocity, deceleration)
    assert limits.way_to_rest == pytest.approx(way)
    page = (launch_library().parent / "docs" / "how-to" / "drive-safely.md").read_text(encoding="utf-8")
    rows = [
        line.split(" | ") for line in page.splitlines() if line.startswith((f"| from {velocity:g} m/s", "| way to"))
    ]
    (column,) = [number for number, title in enumerate(rows[0]) if title.startswith(f"{deceleration:g} m/s²")]
    assert rows[1][column].startswith(f"{way:.2g} m")
    assert f"rests within {way:.2g} m, from {velocity:g} m/s" in limits.describe_stop()


@pytest.mark.parametrize("sight", [0.3, 1.0, 2.0])
def test_fast_base_is_slowed_to_what_it_sees(sight: float) -> None:
    limits = fast(3.0, 2.0).within_sight(sight)
    assert limits.velocity < 3.0
    assert limits.way_to_rest == pytest.approx(sight)
    assert fast(3.0, 2.0).within_sight(12.0).velocity == 3.0
    assert not fast(3.0, 2.0).within_sight(-1.0).velocity
