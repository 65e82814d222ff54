"""The pose graph needs gtsam; where it is missing, one line says so and the tests of what imports it are left out."""

from importlib.util import find_spec

import pytest

MISSING = [name for name in ("gtsam",) if find_spec(name) is None]
_NEED_IT = (
    "test_graph.py",
    "test_mapper.py",
    "test_mapping_conditions.py",
    "test_merge.py",
    "test_neighbours.py",
    "test_slam_gmapping_node.py",
    "test_slam_nodes.py",
    "test_tracker.py",
)
collect_ignore = list(_NEED_IT) if MISSING else []


@pytest.fixture
def missing() -> list[str]:
    return MISSING
