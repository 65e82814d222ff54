"""A few of the sequences that bench/assistant runs by the thousand."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("mcp")

from tests.mcp.robot import AssistedRobot
from tests.mcp.sequences import Allowed, judge, run_sequences


async def test_no_sequence_of_calls_moves_the_robot_beyond_its_grant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    verdict = await run_sequences(AssistedRobot(tmp_path), range(4))
    assert verdict.violations == []
    assert verdict.moving > 20
    assert verdict.calls > 12


def test_motion_without_a_grant_is_a_violation() -> None:
    moving = [(1.0, 0.3, 0.0, 5.0, 0.0)]
    assert judge(moving, []) == ["1.00 s: 0.30 m/s without a grant"]
    assert judge(moving, [Allowed(0.0, 0.3, None)]) == []
    assert judge(moving, [Allowed(0.0, 0.1, None)]) == ["1.00 s: 0.30 m/s, granted 0.10"]
