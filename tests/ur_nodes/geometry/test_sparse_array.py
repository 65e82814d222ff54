import re
from pathlib import Path

import numpy as np
import pytest

from ur_nodes.geometry.sparse_array import sparse_twins, sparse_zeros


def _resident() -> int:
    return int(Path("/proc/self/statm").read_text(encoding="ascii").split()[1]) * 4096


def test_sparse_zeros_take_memory_only_where_they_are_written_to() -> None:
    before = _resident()
    zeros = sparse_zeros((20_000, 10_000), np.uint8)
    zeros[100:200, 100:200] = 7
    assert _resident() - before < 20_000_000
    assert zeros[150, 150] == 7
    assert not zeros[10_000].any()


def test_sparse_zeros_may_be_empty() -> None:
    assert sparse_zeros((0, 5), np.float32).shape == (0, 5)


def test_sparse_twins_take_memory_once_where_they_are_the_same() -> None:
    values = np.full((10_000, 4_000), 3, np.uint8)
    before = _share()
    first, second = sparse_twins(values)
    assert (first == second).all()  # every page of both is used
    second[100:200] = 7
    assert _share() - before < 1.3 * values.nbytes
    assert (second[150] == 7).all()
    assert (first == 3).all()
    with pytest.raises(ValueError, match="read-only"):
        first[0, 0] = 1


def test_sparse_twins_hold_any_values() -> None:
    values = np.arange(35, dtype=np.float64).reshape(5, 7).T
    first, second = sparse_twins(values)
    assert (first == values).all()
    assert (second == values).all()
    assert sparse_twins(np.zeros((0, 3), np.int8))[1].shape == (0, 3)


def _share() -> int:
    """The share of this process in files in memory. That in libraries grows when another process ends."""
    share, named = 0, False
    for line in Path("/proc/self/smaps").read_text(encoding="ascii").splitlines():
        if re.match("[0-9a-f]+-", line):
            named = "/memfd:" in line
        elif named and line.startswith("Pss:"):
            share += int(line.split()[1]) * 1024
    return share
