"""The pose graph needs gtsam; where it is missing, one line says so and the tests of what imports it are left out."""

from __future__ import annotations

from importlib.util import find_spec

import pytest

MISSING = [name for name in ("gtsam",) if find_spec(name) is None]
collect_ignore = ["test_graph.py", "test_mapper.py", "test_slam_gmapping_node.py"] if MISSING else []


@pytest.fixture
def missing() -> list[str]:
    return MISSING
