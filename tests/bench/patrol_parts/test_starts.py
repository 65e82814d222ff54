from __future__ import annotations

import pytest
from bench.patrol_parts.starts import Record, find_starts, find_unasked

DRIVE = [(0.0, 0.0), (10.0, 0.0), (10.1, 0.2), (12.0, 0.3), (13.0, 0.02), (13.1, 0.0), (13.3, 0.0), (13.4, 0.2)]


def test_start_is_a_robot_at_rest_that_moves() -> None:
    assert find_starts(DRIVE) == [10.1]  # 0.3 s at rest is a turn on the way
    assert find_starts([(0.0, 0.3), (1.0, 0.3)]) == []


@pytest.mark.parametrize(
    ("states", "requests", "unasked"),
    [
        ([(9.0, "starting")], [8.0], []),
        ([(9.0, "starting")], [3.0], [9.0]),
        ([(1.0, "starting"), (9.0, "waiting")], [0.5], []),
        ([(1.0, "starting"), (9.0, "paused")], [0.5], [10.1]),
        ([(1.0, "starting"), (9.9, "paused")], [0.5], []),
        ([(0.0, "idle")], [], [10.1]),
    ],
)
def test_start_without_a_young_request_is_found(
    states: list[tuple[float, str]], requests: list[float], unasked: list[float]
) -> None:
    assert find_unasked(Record(DRIVE, states, requests)) == unasked
