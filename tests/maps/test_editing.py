"""Edits with undo; the pose graph of a map with scans goes back, too."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from ur.maps.editing import EditSession
from ur.maps.picture_file import write_picture
from ur.maps.store import PICTURE, MapStore
from ur.source.diagnostic import UserError
from ur.worlds.cells import look_up
from ur.worlds.map_file import read_map

VALUES = np.zeros((40, 60), np.int8)
VALUES[[0, -1]] = VALUES[:, [0, -1]] = 100


@pytest.fixture
def session(tmp_path: Path) -> EditSession:
    store = MapStore(tmp_path / "maps")
    with store.arriving("flat") as folder:
        write_picture(folder / PICTURE.split(".")[0], VALUES, 0.1, (-1.0, -1.0, math.radians(7.0)))
    return EditSession(store, "flat", tmp_path / "waypoints" / "flat.yaml")


def test_changes_are_undone_in_turn_to_the_last_cell(session: EditSession) -> None:
    before = session.image()
    for point in ((0.0, 0.5), (1.0, 0.5)):
        session.mark(*point)
    assert "cells changed" in session.draw("wall")
    assert session.marks == ()
    session.place("door", 1.0, 0.5, 90.0)
    assert session.set_origin(1.0, 0.5) == "(1.00, 0.50) is (0, 0) now"
    assert session.places()["door"] == pytest.approx((0.0, 0.0, 90.0))
    assert "turned by" in session.rotate()
    undone = [session.undo() for _ in range(4)]
    assert undone == ["rotate: undone", "origin: undone", "place door: undone", "wall: undone"]
    after = session.image()
    assert np.array_equal(after.values, before.values)
    assert after.origin == pytest.approx(before.origin)
    assert session.places() == {}
    with pytest.raises(UserError, match="no change to undo"):
        session.undo()


def test_change_of_another_program_is_not_undone(session: EditSession, tmp_path: Path) -> None:
    for point in ((0.0, 0.5), (1.0, 0.5)):
        session.mark(*point)
    session.draw("wall")
    other = EditSession(MapStore(tmp_path / "maps"), "flat", tmp_path / "waypoints" / "flat.yaml")
    for point in ((1.0, 1.0), (2.0, 1.5)):
        other.mark(*point)
    other.zone("keep-out")
    changed = session.image()
    with pytest.raises(UserError, match="changed by another program"):
        session.undo()
    assert np.array_equal(session.image().values, changed.values)


def test_refused_change_leaves_map_marks_and_undo_as_they_were(session: EditSession) -> None:
    session.mark(0.0, 0.0)
    with pytest.raises(UserError, match="1 points for wall"):
        session.draw("wall")
    assert session.marks == ((0.0, 0.0),)
    with pytest.raises(UserError, match="is not a name of a place"):
        session.place("../x", 0.0, 0.0)
    with pytest.raises(UserError, match="no change to undo"):
        session.undo()


def test_zones_leave_the_picture_alone_move_with_the_map_and_are_undone(session: EditSession, tmp_path: Path) -> None:
    before, folder = session.image(), tmp_path / "maps" / "flat"
    for point in ((0.0, 0.0), (1.0, 0.5)):
        session.mark(*point)
    assert session.zone("keep-out") == "zone keep-out: keep out, 0.5 square metres"
    for point in ((2.0, 1.0), (3.0, 1.0), (3.0, 2.0)):
        session.mark(*point)
    assert session.zone("speed", 40) == "zone slow: at most 40 % of the highest speed, 0.5 square metres"
    assert np.array_equal(session.image().values, before.values)
    mask = read_map(folder / "speed_mask.yaml")
    assert look_up(mask, mask.values, np.array((2.9, 1.2)), 0) == 40
    session.set_origin(1.0, 0.0)
    assert session.zones()[0].points[0] == (-1.0, 0.0)
    assert session.delete_zone(-0.5, 0.2) == "zone keep-out is deleted"
    assert not (folder / "keepout_mask.yaml").exists()
    with pytest.raises(UserError, match=r"no zone at \(-0\.50, 0\.20\)"):
        session.delete_zone(-0.5, 0.2)
    for _ in range(3):
        session.undo()
    assert [zone.name for zone in session.zones()] == ["keep-out"]
    assert (folder / "keepout_mask.yaml").exists()
    assert not (folder / "speed_mask.yaml").exists()
