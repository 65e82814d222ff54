from __future__ import annotations

from pathlib import Path

import numpy as np

from ur_nodes.geometry.sparse_array import sparse_zeros


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
