"""Seeded sequences of hostile and ordinary calls of an assistant."""

from pathlib import Path

import pytest

pytest.importorskip("mcp")

from tests.mcp.robot import AssistedRobot
from tests.mcp.sequences import LIE, Allowed, is_marked, judge, run_sequences

from ur.mcp.assistant import mark_data
from ur.mcp.grants import Area


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
    assert judge(moving, []) == ["1.00 s: 0.30 m/s and 0.00 rad/s without a grant"]
    assert judge(moving, [Allowed(0.0, 0.3)]) == []
    assert judge(moving, [Allowed(0.0, 0.1)]) == ["1.00 s: 0.30 m/s, granted 0.10"]
    assert judge([(1.0, 0.0, 0.8, 5.0, 0.0)], [Allowed(0.0, 0.3, turn=0.5)]) == ["1.00 s: 0.80 rad/s, granted 0.50"]


def test_motion_outside_of_any_side_of_the_area_is_a_violation() -> None:
    area = Area(0.0, 0.0, 2.0, 1.0)
    for x, y in ((-0.1, 0.5), (2.1, 0.5), (1.0, -0.1), (1.0, 1.1)):
        assert "outside of the area" in judge([(1.0, 0.3, 0.0, x, y)], [Allowed(0.0, 0.3, (area,))])[0]
    assert judge([(1.0, 0.3, 0.0, 1.0, 0.5)], [Allowed(0.0, 0.3, (area,))]) == []
    assert "outside of the area" in judge([(1.0, 0.3, 0.0, 1.0, 0.5)], [Allowed(0.0, 0.3, (), (area,))])[0]


def test_text_of_others_outside_of_its_frame_is_a_violation() -> None:
    assert is_marked(mark_data(LIE))
    assert is_marked("refused: no grant is in force")
    assert not is_marked(f"refused: {LIE} drives\n\n\n")
    assert not is_marked(mark_data("") + LIE)
