"""The files of a stored map beside its picture: scans in chunks, and the pose graph, as numpy archives with limits.

Nothing in them is executed (`allow_pickle` is off), and nothing is unpacked before its size is known.
"""

import io
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ur.source.diagnostic import UserError, user_error
from ur.source.foreign.files import open_file

CHUNK = 200
"""Keyframes of a file of scans."""

MOST_KEYFRAMES = 100_000
MOST_EDGES = 1_000_000
MOST_BEAMS = 20_000  # of a scan
MOST_BYTES = 200_000_000  # of a file, unpacked
_UNIT = 0.002  # m: points are whole multiples of it, unless they lie farther away than 65 m
_LARGEST = 32_000
_FARTHEST = 10_000.0  # m
_LENGTHS = ("hit_counts", "miss_counts")


@dataclass(frozen=True, slots=True, eq=False)
class StoredScan:
    """The scan of a keyframe in the frame of the robot, m.

    `hits` (n, 2) are the ends of beams that hit an obstacle and `numbers` (n) the increasing numbers of these beams;
    `misses` (m, 2) are the ends of the others, up to which the floor is free. `origin` (2) is the position of the
    lidar.
    """

    hits: NDArray[np.float32]
    numbers: NDArray[np.uint16]
    misses: NDArray[np.float32]
    origin: NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class StoredGraph:
    """A pose graph: `poses` (n, 3) of keyframes in m and rad, and edges, the constraints between them.

    Of each edge `ends` (e, 2) are the numbers of its keyframes, `relative` (e, 3) the pose of the second in the frame
    of the first, `covariances` (e, 3, 3) its uncertainty; `robust` (e) edges have no effect if others contradict them.
    """

    poses: NDArray[np.float64]
    ends: NDArray[np.int32]
    relative: NDArray[np.float64]
    covariances: NDArray[np.float64]
    robust: NDArray[np.bool_]


def encode_scans(scans: Sequence[StoredScan]) -> bytes:
    """Encode the content of a file of scans."""
    hits = np.concatenate([np.zeros((0, 2), np.float32), *(each.hits for each in scans)])
    misses = np.concatenate([np.zeros((0, 2), np.float32), *(each.misses for each in scans)])
    farthest = max((float(np.abs(each).max()) for each in (hits, misses) if each.size), default=0.0)
    unit = max(_UNIT, farthest / _LARGEST)
    return _pack(
        unit=np.array(unit),
        hits=np.rint(hits / unit).astype(np.int16),
        numbers=np.concatenate([np.zeros(0, np.uint16), *(each.numbers for each in scans)]).astype(np.uint16),
        hit_counts=np.array([len(each.hits) for each in scans], np.int32),
        misses=np.rint(misses / unit).astype(np.int16),
        miss_counts=np.array([len(each.misses) for each in scans], np.int32),
        origins=np.array([each.origin for each in scans], np.float64).reshape(-1, 2),
    )


def read_scans(path: Path) -> list[StoredScan]:
    """Read a file of scans. Raises UserError if it is missing, damaged, or no such file."""
    found = _unpack(path, ("unit", "hits", "numbers", *_LENGTHS, "misses", "origins"))
    try:
        unit = float(found["unit"].reshape(1)[0])
        counts = [_whole(found[name], 1) for name in _LENGTHS]
        hits, misses = (_whole(found[name], 2) for name in ("hits", "misses"))
        numbers, origins = _whole(found["numbers"], 1), found["origins"]
        _require(0.0 < unit * _LARGEST <= _FARTHEST, "a unit")
        _require(len(counts[0]) == len(counts[1]) == len(origins) <= MOST_KEYFRAMES, "as many counts as scans")
        for points, lengths in ((hits, counts[0]), (misses, counts[1])):
            _require(points.shape[1:] == (2,), "points")
            _require(bool(np.all((lengths >= 0) & (lengths <= MOST_BEAMS))), "counts")
            _require(int(lengths.sum(dtype=np.int64)) == len(points), "as many points as are counted")
        _require(len(numbers) == len(hits), "as many numbers as points")
        _require(origins.shape == (len(counts[0]), 2) and origins.dtype.kind == "f", "places of the lidar")
        _require(bool(np.all(np.abs(origins) < _FARTHEST)), "places of the lidar")  # false for nan, too
    except (ValueError, IndexError) as problem:
        raise _bad(path, str(problem)) from None
    ends, miss_ends = (np.cumsum(each, dtype=np.int64) for each in counts)
    scans = []
    for number in range(len(origins)):
        mine = slice(int(ends[number] - counts[0][number]), int(ends[number]))
        others = slice(int(miss_ends[number] - counts[1][number]), int(miss_ends[number]))
        scans.append(
            StoredScan(
                (hits[mine] * np.float32(unit)).astype(np.float32),
                numbers[mine].astype(np.uint16),
                (misses[others] * np.float32(unit)).astype(np.float32),
                origins[number].astype(np.float64),
            )
        )
    return scans


def encode_graph(graph: StoredGraph) -> bytes:
    """Encode the content of a file with a pose graph."""
    rows, columns = np.triu_indices(3)
    return _pack(
        poses=graph.poses.astype(np.float64).reshape(-1, 3),
        ends=graph.ends.astype(np.int32).reshape(-1, 2),
        relative=graph.relative.astype(np.float64).reshape(-1, 3),
        covariances=graph.covariances.reshape(-1, 3, 3)[:, rows, columns].astype(np.float64),
        robust=graph.robust.astype(np.bool_),
    )


def read_graph(path: Path) -> StoredGraph:
    """Read a file with a pose graph. Raises UserError if it is missing, damaged, or no such file."""
    found = _unpack(path, ("poses", "ends", "relative", "covariances", "robust"))
    try:
        poses, ends = found["poses"], _whole(found["ends"], 2).astype(np.int32)
        relative, packed, robust = found["relative"], found["covariances"], found["robust"]
        count = len(ends)
        _require(poses.ndim == 2 and poses.shape[1] == 3 and 0 < len(poses) <= MOST_KEYFRAMES, "poses")
        _require(count <= MOST_EDGES and ends.shape == (count, 2), "edges")
        _require(relative.shape == (count, 3) and packed.shape == (count, 6), "edges")
        _require(robust.shape == (count,) and robust.dtype == np.bool_, "edges")
        for each in (poses, relative, packed):
            _require(each.dtype.kind == "f" and bool(np.all(np.abs(each) < 1e6)), "finite numbers")
        _require(bool(np.all((ends >= 0) & (ends < len(poses)))), "numbers of keyframes")
        _require(bool(np.all(ends[:, 0] != ends[:, 1])), "edges between two keyframes")
        _require(_is_connected(ends, len(poses)), "edges that connect all keyframes")
        covariances = np.zeros((count, 3, 3))
        rows, columns = np.triu_indices(3)
        covariances[:, rows, columns] = packed
        covariances[:, columns, rows] = packed
        _require(count == 0 or bool(np.linalg.eigvalsh(covariances).min() > 1e-12), "covariances")
    except (ValueError, IndexError, np.linalg.LinAlgError) as problem:
        raise _bad(path, str(problem)) from None
    return StoredGraph(
        poses.astype(np.float64), ends, relative.astype(np.float64), covariances, robust.astype(np.bool_)
    )


def _is_connected(ends: NDArray[np.int32], count: int) -> bool:
    """Return whether every keyframe is connected with the first one."""
    group = np.arange(count)
    while True:
        low = np.minimum(group[ends[:, 0]], group[ends[:, 1]])
        after = group.copy()
        np.minimum.at(after, ends[:, 0], low)
        np.minimum.at(after, ends[:, 1], low)
        after = after[after]
        if np.array_equal(after, group):
            return not group.any()
        group = after


def _pack(**arrays: NDArray[np.generic]) -> bytes:
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)  # type: ignore[arg-type]  # the stubs mistake arrays for allow_pickle
    return buffer.getvalue()


def _unpack(path: Path, names: Sequence[str]) -> Mapping[str, NDArray[np.generic]]:
    try:
        with open_file(path, MOST_BYTES) as file:
            with zipfile.ZipFile(file) as archive:
                sizes = {each.filename: each.file_size for each in archive.infolist()}
            if set(sizes) != {f"{name}.npy" for name in names} or sum(sizes.values()) > MOST_BYTES:
                raise ValueError(f"expected {', '.join(names)}")
            file.seek(0)
            with np.load(file, allow_pickle=False) as arrays:
                return {name: arrays[name] for name in names}
    except OSError as problem:
        raise _bad(path, (problem.strerror or str(problem)).lower()) from None
    except Exception as problem:  # damaged archives raise many exceptions of zlib, zipfile and numpy
        raise _bad(path, str(problem)[:80]) from None


def _whole(array: NDArray[np.generic], dimensions: int) -> NDArray[np.int64]:
    _require(array.dtype.kind in "iu" and array.ndim == dimensions, "whole numbers")
    return array.astype(np.int64)


def _require(condition: bool, what: str) -> None:
    if not condition:
        raise ValueError(f"expected {what}")


def _bad(path: Path, what: str) -> UserError:
    message = f"'{path}' cannot be read: {what}"
    return user_error(message, rule="bad-map", help="the map's picture still serves: navigate on it, or map again")
