"""Walls of a map in use: drawn and erased in one step. The previous map is saved, so that it can be restored."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ur.maps.change import add_to_record, write_edits
from ur.maps.picture_file import write_picture
from ur.maps.record import MOST_STROKES, MapEdit, MapRecord, render_record
from ur.maps.store import MapStore
from ur.source.diagnostic import UserError, user_error
from ur.source.foreign.files import read_file
from ur.source.foreign.json_values import Count, read_json, write_json
from ur.source.replace import replace_file
from ur.worlds.cells import CellFrame
from ur.worlds.map_file import MapImage, read_map

_BEFORE = "before"  # the picture before the last change
_NOTE = "before.json"  # written last: without it nothing can be restored
_LONGEST_NOTE = 1000


@dataclass(frozen=True, slots=True)
class _UndoRecord:
    """The number of edits before the last change, and the fingerprint of the map after it."""

    version: int
    edits: Count
    left: str


def draw_walls(store: MapStore, name: str, strokes: Sequence[MapEdit], plan: CellFrame) -> MapImage:
    """Draw and erase walls of a map, completely or not at all; return its new picture.

    `plan` are the cells of the map as the program has read it. Raises UserError if they have changed, or another
    program is changing the map; or OSError.
    """
    if not 0 < len(strokes) <= MOST_STROKES or any(each.kind == "keep-out" or not each.width for each in strokes):
        raise _refuse(f"{len(strokes)} strokes, expected 1 to {MOST_STROKES} that draw or erase walls")
    with store.claim(name):
        record, image = store.record(name), read_map(store.picture(name))
        if (image.shape, image.resolution, image.origin) != (plan.shape, plan.resolution, tuple(plan.origin)):
            raise _refuse(f"map {name!r} was turned or made larger since the program has read it, expected the same")
        after = add_to_record(name, record, strokes)
        note = store.path(name) / _NOTE
        note.unlink(missing_ok=True)
        write_picture(store.path(name) / _BEFORE, image.values, image.resolution, image.origin)
        write_edits(store, name, after, image, strokes)
        drawn = read_map(store.picture(name))
        left = _fingerprint(store.record(name), drawn)
        replace_file(note, write_json(_UndoRecord(1, len(record.edits), left)) + "\n")
        return drawn


def restore_walls(store: MapStore, name: str) -> MapImage:
    """Restore the map to its state before the last `draw_walls`; return its picture.

    Raises UserError if there is none, or another program has changed the map since; or OSError.
    """
    with store.claim(name):
        edits = _read_note(store, name)
        if edits is None:
            raise _refuse(f"map {name!r} has no state before its last change, expected one that was drawn on a page")
        record, image = store.record(name), read_map(store.path(name) / f"{_BEFORE}.yaml")
        store.write_record(name, replace(record, edits=record.edits[:edits]))
        write_picture(store.path(name) / "map", image.values, image.resolution, image.origin)
        (store.path(name) / _NOTE).unlink(missing_ok=True)
        return read_map(store.picture(name))


def is_restorable(store: MapStore, name: str) -> bool:
    """Return whether `restore_walls` would restore a map."""
    try:
        return _read_note(store, name) is not None
    except (UserError, OSError):
        return False


def _read_note(store: MapStore, name: str) -> int | None:
    """Return the number of edits before the last change; None if another change followed. Raises UserError."""
    try:
        note = read_json(read_file(store.path(name) / _NOTE, _LONGEST_NOTE), _UndoRecord)
    except (OSError, ValueError):
        return None
    record = store.record(name)
    known = note.edits <= len(record.edits)
    return note.edits if known and note.left == _fingerprint(record, read_map(store.picture(name))) else None


def _fingerprint(record: MapRecord, image: MapImage) -> str:
    """Return a text that differs between maps that differ in anything except their zones."""
    digest = hashlib.sha256(render_record(replace(record, zones=())).encode())
    digest.update(repr((image.resolution, image.origin, image.shape)).encode())
    digest.update(image.values.tobytes())
    return digest.hexdigest()


def _refuse(message: str) -> UserError:
    return user_error(message, rule="bad-edit")
