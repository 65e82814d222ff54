"""The times of recorded messages."""

from __future__ import annotations

from ur_nodes.ros2.recorder.arrivals import Arrivals

SECOND = 10**9


def test_message_that_was_sent_again_does_not_cost_those_that_follow_it() -> None:
    arrivals = Arrivals()
    assert [arrivals.note(moment, 0) for moment in (10, 90, 30, 40, 95)] == [10, 90, 90, 90, 95]


def test_topic_with_a_period_has_one_message_in_it() -> None:
    arrivals = Arrivals()
    moments = [0, SECOND // 2, SECOND, SECOND + 1, 3 * SECOND]
    assert [arrivals.note(moment, SECOND) for moment in moments] == [0, None, SECOND, None, 3 * SECOND]
