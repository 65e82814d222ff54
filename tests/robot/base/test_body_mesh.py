import struct
from collections import Counter
from dataclasses import replace
from pathlib import Path

import pytest

from ur.robot.base import Base, list_bases, list_variants, load_base
from ur.robot.base.body_mesh import Triangle, make_body, write_stl
from ur.robot.base.outline import find_hull, is_inside, measure_area

PACKAGE = Path(__file__).parents[3] / "ubiquity_launches"
EVERY = [(name, variant) for name in list_bases(PACKAGE) for variant in ("", *list_variants(PACKAGE, name))]


@pytest.fixture
def stage() -> Base:
    return load_base(PACKAGE, "stage")


def measure_volume(triangles: list[Triangle]) -> float:
    """By the divergence theorem: positive when every triangle faces outwards."""
    return sum(
        ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)
        for (ax, ay, az), (bx, by, bz), (cx, cy, cz) in triangles
    ) / 6.0  # fmt: skip


@pytest.mark.parametrize(("name", "variant"), EVERY)
def test_body_is_closed_and_as_large_as_the_base(name: str, variant: str) -> None:
    base = load_base(PACKAGE, name, variant)
    outline = base.body or base.footprint
    triangles = make_body(base)
    edges = Counter((a, b) for t in triangles for a, b in zip(t, (*t[1:], t[0]), strict=True))
    assert all(edges[b, a] == count for (a, b), count in edges.items()), "each edge has a neighbour the other way"
    for axis, (low, high) in enumerate(
        (
            (min(x for x, _ in outline), max(x for x, _ in outline)),
            (min(y for _, y in outline), max(y for _, y in outline)),
            (base.ground_clearance, base.height),
        )
    ):
        values = [vertex[axis] for triangle in triangles for vertex in triangle]
        assert (min(values), max(values)) == pytest.approx((low, high))
    assert measure_volume(triangles) > 0.0


def test_body_leaves_out_wells_for_the_wheels(stage: Base) -> None:
    wheels = stage.wheels
    height = stage.height - stage.ground_clearance
    without = measure_volume(make_body(replace(stage, wheels=replace(wheels, separation=1.0))))
    well = measure_volume(make_body(stage))
    assert well < without
    assert without == pytest.approx(height * measure_area(stage.footprint))


def test_body_of_a_base_that_is_lower_than_its_wheels_has_a_deck_all_the_same(stage: Base) -> None:
    low = replace(stage, height=0.12)
    heights = {vertex[2] for triangle in make_body(low) for vertex in triangle}
    assert sorted(heights) == pytest.approx([0.04, 0.11, 0.12])


def test_hull_is_convex_and_goes_round_counter_clockwise() -> None:
    points = [(0.0, 0.0), (2.0, 0.0), (1.0, 0.5), (2.0, 2.0), (0.0, 2.0), (1.0, 0.0)]
    assert find_hull(points) == [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]


@pytest.mark.parametrize(("point", "inside"), [((0.0, 0.0), True), ((1.005, 0.5), True), ((1.02, 0.5), False)])
def test_point_is_inside_a_hull_within_a_tolerance(point: tuple[float, float], inside: bool) -> None:
    assert is_inside(point, [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], 0.01) is inside


def test_body_has_skirts_outside_the_wheels_where_there_is_room() -> None:
    base = load_base(PACKAGE, "botvac")
    low = [v for triangle in make_body(base) for v in triangle if v[2] == base.ground_clearance and abs(v[0]) < 0.045]
    assert max(y for _, y, _ in low) == pytest.approx(0.168)


def test_stl_holds_unit_normals_that_point_outwards(stage: Base) -> None:
    triangles = make_body(stage)
    data = write_stl(triangles)
    (count,) = struct.unpack_from("<I", data, 80)
    assert count == len(triangles)
    assert len(data) == 84 + 50 * count
    records = [struct.unpack_from("<12f", data, 84 + 50 * n) for n in range(count)]
    top = [numbers[:3] for numbers in records if numbers[5::3] == pytest.approx([stage.height] * 3)]
    assert top
    assert set(top) == {(0.0, 0.0, 1.0)}


def test_same_base_gives_the_same_bytes(stage: Base) -> None:
    assert write_stl(make_body(stage)) == write_stl(make_body(stage))
