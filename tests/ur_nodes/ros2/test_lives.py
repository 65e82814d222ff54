"""Lives of a robot on ROS 2, each with a fault: it comes to rest, and nothing is left. See `lives.py` for many."""

from __future__ import annotations

import pytest
from tests.ros2_session import PYTHON
from tests.ur_nodes.ros2.lives import FAULTS, live_all


@pytest.mark.timeout(400)
@pytest.mark.parametrize("fault", ["stop", "kill move_base", "second client"])
def test_robot_comes_to_rest_and_nothing_is_left(fault: str) -> None:
    if not PYTHON.exists():
        pytest.skip("no wheels of ROS 2 for this processor")
    lines: list[str] = []
    assert live_all(1, FAULTS.index(fault), lines.append) == 0, "".join(lines)
