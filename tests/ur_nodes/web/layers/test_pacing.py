"""Work that a step which is called often does from time to time."""

from __future__ import annotations

from ur_nodes.web.layers.pacing import Every


def test_work_is_due_at_once_then_after_its_seconds_and_when_hurried() -> None:
    look = Every(2.0)
    assert [look.due(now) for now in (0.0, 1.0, 2.0, 2.5, 3.9, 4.5)] == [True, False, True, False, False, True]
    look.hurry()
    assert look.due(4.6)
    assert not look.due(5.0)
