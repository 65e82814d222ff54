import io
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ur.maps.scan_file import StoredGraph, StoredScan, encode_graph, encode_scans, read_graph, read_scans
from ur.source.diagnostic import UserError

HITS = np.array(((1.0, 2.0), (-3.0, 0.5)), np.float32)
SCANS = [
    StoredScan(HITS, np.array((4, 7), np.uint16), HITS[:1], np.array((0.1, 0.0))),
    StoredScan(HITS[:0], np.zeros(0, np.uint16), HITS[:0], np.zeros(2)),
]
GRAPH = StoredGraph(
    np.array(((0.0, 0.0, 0.0), (1.0, 0.5, -3.0))),
    np.array(((0, 1),), np.int32),
    np.array(((1.0, 0.5, -3.0),)),
    np.diag((0.01, 0.02, 0.03))[None],
    np.array((True,)),
)


def write(folder: Path, data: bytes) -> Path:
    path = folder / "scans_1.npz"
    path.write_bytes(data)
    return path


def test_scans_are_read_back_to_a_millimetre(tmp_path: Path) -> None:
    read = read_scans(write(tmp_path, encode_scans(SCANS)))
    assert len(read) == 2
    assert read[0].hits == pytest.approx(HITS, abs=0.0011)
    assert read[0].misses == pytest.approx(HITS[:1], abs=0.0011)
    assert read[0].numbers.tolist() == [4, 7]
    assert read[0].origin.tolist() == [0.1, 0.0]
    assert len(read[1].hits) == 0


def test_far_points_are_kept_less_exactly(tmp_path: Path) -> None:
    far = replace(SCANS[0], hits=HITS * np.float32(100.0))
    assert read_scans(write(tmp_path, encode_scans([far])))[0].hits == pytest.approx(HITS * 100.0, abs=0.01)


def test_graph_is_read_back_as_it_was(tmp_path: Path) -> None:
    read = read_graph(write(tmp_path, encode_graph(GRAPH)))
    assert read.poses.tolist() == GRAPH.poses.tolist()
    assert read.ends.tolist() == [[0, 1]]
    assert read.covariances == pytest.approx(GRAPH.covariances)
    assert read.robust.tolist() == [True]


@pytest.mark.parametrize(
    "change",
    [
        {"ends": np.array(((0, 2),), np.int32)},
        {"ends": np.array(((1, 1),), np.int32)},
        {"ends": np.zeros((0, 2), np.int32), "relative": np.zeros((0, 3)), "covariances": np.zeros((0, 3, 3))},
        {"poses": np.full((2, 3), np.nan)},
        {"relative": np.zeros((1, 2))},
        {"covariances": -np.eye(3)[None]},
    ],
)
def test_graph_that_makes_no_sense_is_refused(change: dict[str, Any], tmp_path: Path) -> None:
    with pytest.raises(UserError, match="cannot be read"):
        read_graph(write(tmp_path, _pack(_arrays(encode_graph(GRAPH)) | _packed(change))))


def test_other_content_is_refused(tmp_path: Path) -> None:
    whole = encode_scans(SCANS)
    arrays = _arrays(whole)
    for data in (
        b"",
        b"PK",
        whole[:-30],
        whole[:200] + b"\0" * 20 + whole[220:],
        _pack(arrays | {"hit_counts": np.array((3, 0), np.int32)}),
        _pack(arrays | {"hit_counts": np.array((-1, 3), np.int32)}),
        _pack(arrays | {"origins": np.full((2, 2), np.inf)}),
        _pack(arrays | {"more": np.zeros(1)}),
        _pack(arrays | {"unit": np.array(np.nan)}),
    ):
        with pytest.raises(UserError, match="cannot be read"):
            read_scans(write(tmp_path, data))


def test_pickled_content_is_not_executed(tmp_path: Path) -> None:
    marker = tmp_path / "marker"

    class Hostile:
        def __reduce__(self) -> tuple[object, tuple[object, ...]]:
            return (Path.touch, (marker,))

    data = _pack(_arrays(encode_scans(SCANS)) | {"hits": np.array([Hostile()], dtype=object)})
    with pytest.raises(UserError, match="cannot be read"):
        read_scans(write(tmp_path, data))
    assert not marker.exists()


def test_archive_that_unpacks_to_gigabytes_is_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "scans_1.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name in _arrays(encode_scans(SCANS)):
            archive.writestr(f"{name}.npy", bytes(30_000_000))
    with pytest.raises(UserError, match="cannot be read"):
        read_scans(path)


def _arrays(data: bytes) -> dict[str, Any]:
    with np.load(io.BytesIO(data)) as arrays:
        return dict(arrays)


def _pack(arrays: dict[str, Any]) -> bytes:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def _packed(change: dict[str, Any]) -> dict[str, Any]:
    rows, columns = np.triu_indices(3)
    found = dict(change)
    if "covariances" in found:
        found["covariances"] = found["covariances"][:, rows, columns].astype(np.float32)
        found["robust"] = np.ones(len(found["covariances"]), np.bool_)
    return found
