import math

import numpy as np
import pytest

from ur.maps.edit import apply_edits, move_graph, move_point, move_record, propose_turn, turn_values
from ur.maps.record import MapEdit, MapRecord
from ur.maps.scan_file import StoredGraph

SQUARE = ((1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0))


def test_erased_walls_become_floor_and_unknown_stays() -> None:
    values = np.full((30, 30), 100, np.int8)
    values[15, 15] = -1
    edited = apply_edits(values, 0.1, (0.0, 0.0, 0.0), [MapEdit("erase", SQUARE)])
    assert (edited == 0).sum() == 99
    assert edited[15, 15] == -1
    assert (values == 0).sum() == 0


def test_later_edits_count() -> None:
    values = np.zeros((30, 30), np.int8)
    wall = MapEdit("wall", ((0.05, 0.05), (2.95, 2.95)))
    assert (apply_edits(values, 0.1, (0.0, 0.0, 0.0), [wall]) == 100).sum() == 30
    edited = apply_edits(values, 0.1, (0.0, 0.0, 0.0), [MapEdit("keep-out", SQUARE), wall, MapEdit("erase", SQUARE)])
    assert (edited == 100).sum() == 20


def test_edits_outside_of_the_map_change_nothing() -> None:
    values = np.zeros((5, 5), np.int8)
    far = [MapEdit("wall", ((50.0, 50.0), (60.0, 50.0))), MapEdit("keep-out", SQUARE)]
    assert not apply_edits(values, 0.1, (-9.0, -9.0, 0.0), far).any()


def test_brush_covers_its_width_along_a_line_and_round_its_ends() -> None:
    values = np.zeros((40, 60), np.int8)
    edited = apply_edits(values, 0.05, (0.0, 0.0, 0.0), [MapEdit("wall", ((0.5, 1.0), (2.0, 1.0)), 0.2)])
    rows, columns = np.nonzero(edited)
    assert (rows.min(), rows.max(), columns.min(), columns.max()) == (18, 21, 8, 41)
    assert (edited[18:22, 10:40] == 100).all()
    assert edited[18, 8] == 0, "its ends are round"
    erased = apply_edits(edited, 0.05, (0.0, 0.0, 0.0), [MapEdit("erase", ((1.0, 0.0), (1.0, 2.0)), 0.4)])
    assert (erased[:, 16:24] == 0).all()
    assert (erased != edited).sum() == 4 * 8


@pytest.mark.parametrize("end", [(2.9, 0.3), (2.9, 2.9), (0.4, 2.9)])
def test_narrow_brush_leaves_no_gaps_however_the_map_is_turned(end: tuple[float, float]) -> None:
    values = np.zeros((60, 60), np.int8)
    for yaw in (0.0, 0.3):
        edited = apply_edits(values, 0.05, (0.0, 0.0, yaw), [MapEdit("wall", ((1.0, 1.2), end), 0.01)])
        reached = np.zeros_like(edited, bool)
        reached[tuple(np.argwhere(edited)[0])] = True
        for _ in range(100):  # to the four neighbours
            around = reached.copy()
            around[1:] |= reached[:-1]
            around[:-1] |= reached[1:]
            around[:, 1:] |= reached[:, :-1]
            around[:, :-1] |= reached[:, 1:]
            reached = around & (edited == 100)
        assert (reached == (edited == 100)).all()
        assert 20 < reached.sum() < 150


def test_brush_that_runs_far_beyond_a_large_map_draws_the_part_on_it() -> None:
    values = np.zeros((2000, 2000), np.int8)
    stroke = MapEdit("wall", ((-9000.0, -9000.0), (9000.0, 9000.0)), 0.1)
    edited = apply_edits(values, 0.05, (0.0, 0.0, 0.0), [stroke])
    assert (np.diagonal(edited) == 100).all()
    assert 2000 < (edited == 100).sum() < 10_000


def test_turn_that_is_proposed_brings_walls_along_the_axes() -> None:
    values = np.full((200, 200), -1, np.int8)
    turn = math.radians(7.3)
    corners = [
        move_point(p, (5.0, 5.0, turn)) for p in ((-3.0, -2.0), (3.0, -2.0), (3.0, 2.0), (-3.0, 2.0), (-3.0, -2.0))
    ]
    tilted = apply_edits(values, 0.05, (0.0, 0.0, 0.0), [MapEdit("wall", tuple(corners))])
    assert math.degrees(propose_turn(tilted, 0.05, (0.0, 0.0, 0.0))) == pytest.approx(-7.3, abs=0.3)
    assert propose_turn(values, 0.05, (0.0, 0.0, 0.0)) == 0.0


def test_turned_map_keeps_its_walls() -> None:
    values = np.zeros((40, 60), np.int8)
    values[:, 30] = 100
    turned, origin = turn_values(values, 0.05, (-1.5, -1.0, 0.0), (0.0, 0.0, math.pi / 6))
    rows, columns = np.nonzero(turned == 100)
    points = np.stack((origin[0] + (columns + 0.5) * 0.05, origin[1] + (rows + 0.5) * 0.05), axis=-1)
    aside = points @ (math.cos(math.pi / 6), math.sin(math.pi / 6))
    assert np.abs(aside - 0.025).max() < 0.05
    assert (turned == 0).sum() == pytest.approx((values == 0).sum(), rel=0.05)


def test_graph_and_edits_move_together() -> None:
    motion = (1.0, 0.0, math.pi / 2)
    graph = StoredGraph(
        np.array(((2.0, 0.0, 3.0),)),
        np.zeros((0, 2), np.int32),
        np.zeros((0, 3)),
        np.zeros((0, 3, 3)),
        np.zeros(0, bool),
    )
    assert move_graph(graph, motion).poses[0] == pytest.approx((1.0, 2.0, 3.0 + math.pi / 2 - 2 * math.pi))
    record = move_record(MapRecord(edits=(MapEdit("wall", ((2.0, 0.0), (0.0, 0.0))),)), motion)
    assert np.array(record.edits[0].points) == pytest.approx(np.array(((1.0, 2.0), (1.0, 0.0))))
