import pytest

from ur.run.master.monitor import BUSY, LinkState, MasterState, choose_limit, is_another, step_link
from ur.run.supervisor.events import Event, LinkLost, LinkRestored, MasterReplaced, MasterReturned, RobotMasterLost

MASTER = MasterState(100, "a")


def follow(*words: tuple[float, MasterState | None]) -> list[Event]:
    """All events of these answers, each at a time."""
    state, events = LinkState(0.0), list[Event]()
    for now, answer in words:
        state, more = step_link(state, answer, now)
        events += more
    return events


def test_link_that_answers_is_not_mentioned() -> None:
    assert follow((0.3, MASTER), (0.6, MASTER), (0.9, MASTER)) == []


def test_lost_answers_of_less_than_a_second_are_not_mentioned() -> None:
    assert follow((0.3, MASTER), (0.8, None), (1.1, MASTER)) == []


def test_lost_link_is_told_after_a_second_and_again_until_it_is_restored() -> None:
    events = follow((1.0, MASTER), (1.5, None), (2.0, None), (2.5, None), (13.25, MASTER))
    assert events == [LinkLost(1.0), LinkLost(1.5), LinkRestored(12.25)]


def test_slow_master_is_no_lost_link() -> None:
    assert follow((1.0, MASTER), (3.0, BUSY), (5.0, BUSY), (5.5, MASTER)) == []


def test_other_process_or_run_id_is_another_master() -> None:
    assert follow((1.0, MASTER), (1.3, MasterState(200, "b"))) == [MasterReplaced()]
    assert is_another(MASTER, MasterState(100, "b"))  # a computer that has restarted may give the same process id
    assert not is_another(MasterState(100), MASTER)  # its run id is set a little later
    assert not is_another(MASTER, MASTER)


def test_robot_that_has_restarted_has_another_master_after_the_link_is_restored() -> None:
    events = follow((1.0, MASTER), (2.0, None), (40.0, MasterState(100, "b")))
    assert events == [LinkLost(1.0), LinkRestored(39.0), MasterReplaced()]


def test_robot_without_a_master_is_told_after_a_while() -> None:
    gone = MasterState(None)
    events = follow((1.0, MASTER), (1.5, gone), (3.0, gone), (4.5, gone), (5.0, gone), (5.5, MASTER))
    assert events == [RobotMasterLost(3.0), RobotMasterLost(3.5), MasterReturned()]


@pytest.mark.parametrize(("last", "now", "limit"), [(0.0, 0.3, 0.5), (0.0, 0.8, 0.2), (0.0, 5.0, 0.2)])
def test_question_is_short_enough_to_tell_a_loss_after_a_second(last: float, now: float, limit: float) -> None:
    assert choose_limit(LinkState(last), now) == pytest.approx(limit)
