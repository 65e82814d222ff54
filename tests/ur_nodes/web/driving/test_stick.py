from ur_nodes.web.driving.driver_link import ChallengeTimes, age_of_answer, keep_challenge
from ur_nodes.web.driving.page_lease import GAP, StickState, end_stick, expire_stick, let_go, step_stick


def held() -> StickState:
    state, verdict = step_stick(StickState(), 1, 0.02, 10.0)
    assert verdict == "drive"
    return state


def test_young_commands_of_a_press_drive() -> None:
    state = held()
    for step in range(20):
        state, verdict = step_stick(state, 1, 0.05, 10.0 + 0.02 * step)
        assert verdict == "drive"


def test_late_command_ends_the_press_until_the_stick_is_let_go() -> None:
    state, verdict = step_stick(held(), 1, 0.16, 10.1)
    assert verdict == "over"
    for now in (10.12, 10.2, 11.0):
        state, verdict = step_stick(state, 1, 0.01, now)
        assert verdict == "ignore"
    assert step_stick(state, 2, 0.01, 11.1)[1] == "drive"


def test_command_with_an_unknown_challenge_ends_the_press() -> None:
    assert step_stick(held(), 1, None, 10.02)[1] == "over"


def test_press_that_begins_late_never_drives() -> None:
    state, verdict = step_stick(StickState(), 1, 2.0, 10.0)
    assert verdict == "over"
    assert step_stick(state, 1, 0.01, 10.1)[1] == "ignore"


def test_gap_between_young_commands_ends_the_press() -> None:
    assert step_stick(held(), 1, 0.01, 10.0 + GAP + 0.01)[1] == "over"


def test_gap_is_noticed_without_a_command_and_only_once() -> None:
    state, verdict = expire_stick(held(), 9.9 + GAP)
    assert verdict == "ignore"
    state, verdict = expire_stick(state, 10.01 + GAP)
    assert verdict == "over"
    assert expire_stick(state, 20.0)[1] == "ignore"
    assert step_stick(state, 1, 0.01, 20.0)[1] == "ignore"


def test_commands_that_arrive_after_the_release_are_ignored() -> None:
    state, verdict = let_go(held(), 1)
    assert verdict == "over"
    assert step_stick(state, 1, 0.01, 10.02)[1] == "ignore"


def test_older_presses_change_nothing() -> None:
    state, _ = step_stick(held(), 2, 0.01, 10.1)
    assert step_stick(state, 1, 0.01, 10.11) == (state, "ignore")
    assert let_go(state, 1) == (state, "ignore")


def test_page_that_goes_ends_its_press() -> None:
    state, verdict = end_stick(held())
    assert verdict == "over"
    assert end_stick(state)[1] == "ignore"


def test_answers_are_as_old_as_their_challenge_and_forgotten_ones_have_no_age() -> None:
    received = keep_challenge(keep_challenge(ChallengeTimes(), (1, 0), 5.0), (1, 20), 5.5)
    assert age_of_answer(received, (1, 0), 5.6) == 5.6 - 5.0
    assert age_of_answer(received, (9, 9), 5.6) is None
    assert age_of_answer(received, (1, 0), 6.1) is None
    assert (1, 0) not in keep_challenge(received, (2, 0), 6.2).at
