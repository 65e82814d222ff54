"""Zones are stored with their map, and what cannot be one is refused."""

from pathlib import Path

import pytest

from ur.maps.edit import Lattice
from ur.maps.record import MOST_ZONES, Zone, ZoneKind
from ur.maps.zones import delete_zone, find_home, fresh_zone_name, join_zones, make_zone, put_zone
from ur.source.diagnostic import UserError

PLAN = Lattice((100, 100), 0.05, (0.0, 0.0, 0.0))
STAIRS = make_zone("stairs", "keep-out", [(1.0, 1.0), (2.0, 3.0)])


def test_zones_of_a_stored_map_are_in_its_record_and_those_of_others_in_the_users_folder(tmp_path: Path) -> None:
    env = {"XDG_DATA_HOME": str(tmp_path), "HOME": str(tmp_path)}
    maps = tmp_path / "ubiquity_launches" / "maps"
    store, name = find_home(maps / "flat" / "map.yaml", env)
    assert (store.folder, name) == (maps, "flat")
    store, name = find_home(Path("/usr/share/maze.yaml"), env)
    assert (store.folder, name) == (tmp_path / "ubiquity_launches" / "zones", "maze")
    assert find_home(Path("/tmp/2nd floor.yaml"), env)[1] == "map-2nd_floor"
    put_zone(store, name, STAIRS, PLAN)
    assert store.record(name).zones == (STAIRS,)
    assert (store.path(name) / "keepout_mask.yaml").exists()


def test_zone_replaces_the_one_of_its_name_and_is_deleted(tmp_path: Path) -> None:
    store, _ = find_home(Path("maze.yaml"), {"XDG_DATA_HOME": str(tmp_path), "HOME": str(tmp_path)})
    slow = make_zone("stairs", "speed", STAIRS.points, 30)
    assert put_zone(store, "maze", STAIRS, PLAN)
    assert not put_zone(store, "maze", slow, PLAN)
    assert store.record("maze").zones == (slow,)
    with pytest.raises(UserError, match="unknown zone 'stair', expected one of: stairs"):
        delete_zone(store, "maze", "stair", PLAN)
    with store.claim("maze"), pytest.raises(UserError, match="in use"):
        delete_zone(store, "maze", "stairs", PLAN)
    delete_zone(store, "maze", "stairs", PLAN)
    assert store.record("maze").zones == ()


@pytest.mark.parametrize(
    ("name", "kind", "points", "percent", "message"),
    [
        ("../x", "keep-out", [(0, 0), (1, 1)], 0, "not a name of a zone"),
        ("a", "keep-out", [(0, 0)], 0, "1 corners"),
        ("a", "keep-out", [(0, 0), (1, 1), (2, 2)], 0, "no area"),
        ("a", "keep-out", [(0, 0), (float("nan"), 1)], 0, "farther away"),
        ("a", "speed", [(0, 0), (1, 1)], 4, "expected 5 to 99 percent"),
        ("a", "speed", [(0, 0), (1, 1)], 100, "expected 5 to 99 percent"),
    ],
)
def test_what_is_no_zone_is_refused(
    name: str, kind: ZoneKind, points: list[tuple[float, float]], percent: int, message: str
) -> None:
    with pytest.raises(UserError, match=message):
        make_zone(name, kind, points, percent)


def test_names_are_free_ones() -> None:
    second = Zone("keep-out", "keep-out", STAIRS.points)
    assert fresh_zone_name("keep-out", [second]) == "keep-out-2"
    assert fresh_zone_name("speed", [second]) == "slow"
    assert [each.name for each in join_zones([STAIRS], [STAIRS, second])] == ["stairs", "stairs-2", "keep-out"]
    assert len(join_zones([STAIRS] * MOST_ZONES, [STAIRS])) == MOST_ZONES
