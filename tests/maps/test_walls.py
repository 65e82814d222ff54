from pathlib import Path

import numpy as np
import pytest

from ur.maps.change import add_edit, make_edit
from ur.maps.exchange import import_picture
from ur.maps.picture_file import write_picture
from ur.maps.record import MOST_STROKES, MapEdit, Zone
from ur.maps.store import MapStore
from ur.maps.walls import draw_walls, is_restorable, restore_walls
from ur.maps.zones import put_zone
from ur.source.diagnostic import UserError
from ur.worlds.map_file import MapImage, read_map

WALL = MapEdit("wall", ((0.5, 0.5), (0.5, 2.5)), 0.2)
ERASE = MapEdit("erase", ((3.05, 0.0), (3.05, 4.0)), 0.3)


@pytest.fixture
def store(tmp_path: Path) -> MapStore:
    values = np.zeros((40, 60), np.int8)
    values[:, 30] = 100
    made = MapStore(tmp_path / "maps")
    import_picture(made, write_picture(tmp_path / "plan", values, 0.1, (0.0, 0.0, 0.0)), "flat")
    return made


@pytest.fixture
def plan(store: MapStore) -> MapImage:
    return read_map(store.picture("flat"))


def test_walls_are_drawn_and_erased_and_the_map_before_is_restored(store: MapStore, plan: MapImage) -> None:
    assert not is_restorable(store, "flat")
    drawn = draw_walls(store, "flat", [WALL, ERASE], plan)
    assert (drawn.values[5:25, 4:6] == 100).all()
    assert not (drawn.values[:, 30] == 100).any()
    assert (read_map(store.picture("flat")).values == drawn.values).all()
    assert store.record("flat").edits == (WALL, ERASE)
    assert is_restorable(store, "flat")
    assert (restore_walls(store, "flat").values == plan.values).all()
    assert store.record("flat").edits == ()
    assert not is_restorable(store, "flat")
    with pytest.raises(UserError, match="no state before"):
        restore_walls(store, "flat")


def test_zone_that_is_made_later_stays_when_the_map_is_restored(store: MapStore, plan: MapImage) -> None:
    draw_walls(store, "flat", [WALL], plan)
    zone = Zone("hall", "keep-out", ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0)))
    put_zone(store, "flat", zone, plan)
    restore_walls(store, "flat")
    assert store.record("flat").zones == (zone,)


def test_change_of_another_program_is_never_lost_by_restoring(store: MapStore, plan: MapImage) -> None:
    draw_walls(store, "flat", [WALL], plan)
    add_edit(store, "flat", make_edit("wall", [(4.0, 0.0), (4.0, 3.0)]))
    assert not is_restorable(store, "flat")
    with pytest.raises(UserError):
        restore_walls(store, "flat")
    draw_walls(store, "flat", [ERASE], plan)
    assert (restore_walls(store, "flat").values[0:30, 40] == 100).all()


def test_map_that_was_replaced_meanwhile_is_not_drawn_on(store: MapStore, plan: MapImage) -> None:
    write_picture(store.path("flat") / "map", np.zeros((41, 60), np.int8), 0.1, (0.0, 0.0, 0.0))
    with pytest.raises(UserError, match="turned or made larger"):
        draw_walls(store, "flat", [WALL], plan)
    assert store.record("flat").edits == ()


@pytest.mark.parametrize("strokes", [[], [WALL] * (MOST_STROKES + 1), [MapEdit("wall", WALL.points)]])
def test_what_is_no_stroke_of_a_brush_is_refused(store: MapStore, plan: MapImage, strokes: list[MapEdit]) -> None:
    with pytest.raises(UserError, match="strokes, expected 1 to"):
        draw_walls(store, "flat", strokes, plan)


def test_record_that_would_be_too_large_to_be_read_is_not_written(store: MapStore, plan: MapImage) -> None:
    long = MapEdit("wall", tuple((0.1 + each / 1e9, 1.0) for each in range(1000)), 0.1)
    with pytest.raises(UserError, match="edits, expected fewer"):
        draw_walls(store, "flat", [long] * MOST_STROKES, plan)
    assert (read_map(store.picture("flat")).values == plan.values).all()
    assert store.record("flat").edits == ()
    draw_walls(store, "flat", [WALL], plan)
    with pytest.raises(UserError):
        draw_walls(store, "flat", [long] * MOST_STROKES, plan)
    assert is_restorable(store, "flat"), "what was drawn before"


def test_map_that_another_program_changes_is_in_use(store: MapStore, plan: MapImage) -> None:
    with store.claim("flat"), pytest.raises(UserError, match="in use"):
        draw_walls(store, "flat", [WALL], plan)


@pytest.mark.parametrize("note", ["", "[]", '{"edits": 7, "left": ""}', '{"edits": "x"}', "x" * 5000])
def test_damaged_note_of_the_state_before_restores_nothing(store: MapStore, plan: MapImage, note: str) -> None:
    draw_walls(store, "flat", [WALL], plan)
    (store.path("flat") / "before.json").write_text(note)
    assert not is_restorable(store, "flat")
