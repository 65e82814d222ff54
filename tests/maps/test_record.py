import json
from pathlib import Path
from typing import Any

import pytest

from ur.maps.record import MapEdit, MapRecord, Zone, parse_record, read_record, render_record
from ur.source.diagnostic import UserError

RECORD = MapRecord(
    "magni lidar",
    1e9,
    2e9,
    3,
    0.05,
    0.25,
    "graph_2.npz",
    ("scans_1.npz",),
    (MapEdit("wall", ((0.0, 0.0), (1.0, 2.5))),),
    (
        Zone("stairs", "keep-out", ((0.0, 0.0), (1.0, 2.5), (2.0, 0.0))),
        Zone("hall", "speed", ((0.0, 0.0), (1.0, 2.5), (2.0, 0.0)), 40),
    ),
)


def test_record_is_read_back_as_it_was() -> None:
    assert parse_record(render_record(RECORD).encode(), Path("map.json")) == RECORD


def test_map_without_a_record_has_an_empty_one(tmp_path: Path) -> None:
    assert read_record(tmp_path) == MapRecord()


@pytest.mark.parametrize(
    "change",
    [
        {"version": 2},
        {"graph": "../../.bashrc"},
        {"scans": ["/etc/passwd"]},
        {"scans": "scans_1.npz"},
        {"keyframes": -1},
        {"made": float("nan")},
        {"resolution": 0},
        {"resolution": True},
        {"edits": [{"kind": "explode", "points": [[0, 0], [1, 1]]}]},
        {"edits": [{"kind": "erase", "points": [[0, 0], [1, 1]]}]},
        {"edits": [{"kind": "wall", "points": [[0, 0], [1, "2"]]}]},
        {"edits": [{"kind": "wall", "points": [[0, 0], [1, 2]], "width": -0.1}]},
        {"edits": [{"kind": "wall", "points": [[0, 0], [1, 2]], "width": float("inf")}]},
        {"edits": [{"kind": "keep-out", "points": [[0, 0], [1, 2], [1, 3]], "width": 0.1}]},
        {"edits": [[]]},
        {"zones": [[]]},
        {"zones": [{"name": "../x", "kind": "keep-out", "points": [[0, 0], [1, 1], [1, 0]]}]},
        {"zones": [{"name": "a", "kind": "explode", "points": [[0, 0], [1, 1], [1, 0]]}]},
        {"zones": [{"name": "a", "kind": "keep-out", "points": [[0, 0], [1, 1]]}]},
        {"zones": [{"name": "a", "kind": "keep-out", "points": [[0, 0], [1, 1]] * 60}]},
        {"zones": [{"name": "a", "kind": "speed", "percent": 0, "points": [[0, 0], [1, 1], [1, 0]]}]},
        {"zones": [{"name": "a", "kind": "speed", "percent": True, "points": [[0, 0], [1, 1], [1, 0]]}]},
        {"zones": [{"name": "a", "kind": "speed", "percent": 100, "points": [[0, 0], [1, 1], [1, 0]]}]},
    ],
)
def test_record_that_makes_no_sense_is_refused(change: dict[str, Any]) -> None:
    text = json.dumps({**json.loads(render_record(RECORD)), **change})
    with pytest.raises(UserError, match=r"'flat/map\.json': not the record of a map"):
        parse_record(text.encode(), Path("flat/map.json"))


@pytest.mark.parametrize("data", [b"", b"[]", b"\xff\xfe", b"[" * 100_000])
def test_other_texts_are_refused(data: bytes) -> None:
    with pytest.raises(UserError, match="not the record of a map"):
        parse_record(data, Path("map.json"))
