"""Work that a step which is called often does from time to time."""

from ur_nodes.web.layers.pacing import Every


def test_work_is_due_at_once_then_after_its_seconds_and_when_hurried() -> None:
    look = Every(2.0)
    assert [look.due(now) for now in (0.0, 1.0, 2.0, 2.5, 3.9, 4.5)] == [True, False, True, False, False, True]
    look.hurry()
    assert look.due(4.6)
    assert not look.due(5.0)


def test_steps_that_come_unevenly_keep_the_pace() -> None:
    every = Every(0.1)
    steps = [0.05 * step + (0.004 if step % 3 else 0.0) for step in range(2000)]
    assert sum(map(every.due, steps)) in range(998, 1002)


def test_pause_is_not_made_up_for() -> None:
    every = Every(1.0)
    assert [every.due(now) for now in (0.0, 10.5, 10.6, 11.4, 11.6)] == [True, True, False, False, True]
