"""The state of a command for several robots: nothing begins twice or beyond the limit, and every end is kept."""

from ur.fleet.jobs import (
    Fleet,
    Job,
    answer_questions,
    are_all_asking,
    begin_job,
    end_job,
    find_exit_code,
    find_startable,
    interrupt_fleet,
    is_over,
    note_question,
    plan_fleet,
)


def make_fleet(count: int) -> Fleet:
    return plan_fleet([Job(f"r{number}", ("true",)) for number in range(count)])


def test_jobs_begin_in_order_and_never_more_than_the_limit() -> None:
    fleet = make_fleet(5)
    assert find_startable(fleet, 2) == [0, 1]
    fleet = begin_job(begin_job(fleet, 0, 1.0), 1, 1.0)
    assert find_startable(fleet, 2) == []
    fleet = end_job(fleet, 1, 0, 3.0)
    assert find_startable(fleet, 2) == [2]


def test_job_that_asks_makes_room_and_all_are_answered_when_none_runs() -> None:
    fleet = begin_job(begin_job(make_fleet(3), 0, 1.0), 1, 1.0)
    fleet = note_question(fleet, 0)
    assert find_startable(fleet, 2) == [2]
    assert not are_all_asking(fleet)
    fleet = end_job(fleet, 1, 2, 2.0)
    fleet = note_question(begin_job(fleet, 2, 2.0), 2)
    assert are_all_asking(fleet)
    assert [each.phase for each in answer_questions(fleet)] == ["running", "done", "running"]


def test_exit_code_is_the_highest_and_a_signal_counts_as_a_shell_counts_it() -> None:
    fleet = make_fleet(3)
    for index, code in enumerate((0, 2, -9)):
        fleet = end_job(begin_job(fleet, index, 1.0), index, code, 2.0)
    assert is_over(fleet)
    assert [each.code for each in fleet] == [0, 2, 137]
    assert find_exit_code(fleet) == 137


def test_interruption_keeps_what_was_done() -> None:
    fleet = end_job(begin_job(make_fleet(3), 0, 1.0), 0, 0, 2.0)
    fleet = interrupt_fleet(begin_job(fleet, 1, 1.0), 4.0)
    assert [each.code for each in fleet] == [0, 130, 130]
    assert is_over(fleet)


def test_password_of_a_job_is_not_in_its_text() -> None:
    assert "hunter2" not in repr(Job("bob", ("ur",), stdin="hunter2\n"))
