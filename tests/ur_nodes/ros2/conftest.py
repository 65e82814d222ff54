"""A session of ROS 2 for a test."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.ros2_session import PYTHON, Ros2Session


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Ros2Session]:
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    started = Ros2Session(tmp_path)
    try:
        yield started
    finally:
        started.close()
