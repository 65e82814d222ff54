import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.navigation.goals.goal_claim import (
    REMEMBERED,
    Claim,
    ReceivedChallenges,
    age_of_answer,
    has_any_heading,
    lag_of_answer,
    note_challenge,
    read_claim,
    write_any_heading,
    write_goal_id,
)

SECOND = 1_000_000_000


def hear(*arrivals: tuple[float, float]) -> ReceivedChallenges:
    """Challenges of (value, arrival), both in s."""
    challenges = ReceivedChallenges()
    for value, at in arrivals:
        challenges = note_challenge(challenges, round(value * SECOND), at)
    return challenges


@given(
    st.text(max_size=40),
    st.from_regex(r"[0-9A-Za-z_.:-]{1,64}", fullmatch=True),
    st.integers(0, 9_999_999_999 * SECOND),
)
def test_claim_survives_the_goal_id(start: str, client: str, answer: int) -> None:
    assert read_claim(write_goal_id(start, client, answer)) == Claim(client, answer)


def test_goal_without_a_heading_says_so_in_its_id_with_and_without_a_claim() -> None:
    start = write_any_heading("/node-3-17.250")
    claimed = write_goal_id(start, "aa:1", 17 * SECOND)
    assert has_any_heading(start)
    assert has_any_heading(claimed)
    assert read_claim(claimed) == Claim("aa:1", 17 * SECOND)


@pytest.mark.parametrize(
    "goal_id", ["", "/node-3-17.250", "!any-heading-1", "!any-heading" + 2000 * " ", "any-heading"]
)
def test_other_goals_ask_for_a_heading(goal_id: str) -> None:
    assert not has_any_heading(goal_id)
    assert not has_any_heading(write_goal_id("/node-3", "!any-heading", SECOND))


@pytest.mark.parametrize(
    "goal_id",
    [
        "",
        "/rviz-3-1700000000.123",
        "a@b",
        "a@b@c",
        "a@b@1.2.3",
        "a@ü@1.2",
        "a@b c@1.2",
        "a@@1.2",
        f"a@{'b' * 65}@1.2",
        "a@b@1.2\n",
    ],
)
def test_ids_of_other_programs_claim_nothing(goal_id: str) -> None:
    assert read_claim(goal_id) is None


@given(st.text())
def test_any_id_is_read_without_an_error(goal_id: str) -> None:
    read_claim(goal_id)


def test_age_of_an_answer_counts_from_the_arrival_of_its_challenge() -> None:
    challenges = hear((100.0, 5.0), (100.03, 5.03))
    assert age_of_answer(challenges, round(100.03 * SECOND), 5.5) == pytest.approx(0.47)
    assert age_of_answer(challenges, 100 * SECOND, 5.5) == pytest.approx(0.5)


def test_age_of_an_unknown_or_forgotten_answer_is_unknown() -> None:
    challenges = hear((100.0, 5.0))
    assert age_of_answer(challenges, 99 * SECOND, 5.1) is None
    assert age_of_answer(challenges, 100 * SECOND, 5.1 + REMEMBERED) is None
    assert age_of_answer(ReceivedChallenges(), 100 * SECOND, 5.1) is None


def test_challenges_that_arrive_together_after_a_cut_are_as_old_as_their_values_say() -> None:
    challenges = hear((100.0, 9.0), (104.0, 9.0))
    assert age_of_answer(challenges, 100 * SECOND, 9.0) == pytest.approx(4.0)


def test_answer_to_a_challenge_that_the_receiver_missed_counts_from_the_one_before() -> None:
    challenges = hear((5.0, 100.0), (5.03, 100.03), (5.09, 100.09))
    assert age_of_answer(challenges, round(5.06 * SECOND), 100.1) == pytest.approx(0.07)


def test_answer_to_a_challenge_that_reached_the_client_first_counts_from_the_one_before() -> None:
    challenges = hear((5.0, 100.0), (5.03, 100.03))
    assert age_of_answer(challenges, round(5.06 * SECOND), 100.05) == pytest.approx(0.02)
    assert age_of_answer(challenges, round(9.0 * SECOND), 100.05) is None  # another mux's


def test_lag_of_a_forgotten_answer_is_guessed_from_the_values() -> None:
    assert lag_of_answer(hear((103.0, 5.0)), 100 * SECOND, 5.2) == pytest.approx(3.2)
    assert lag_of_answer(hear((3.0, 5.0)), 100 * SECOND, 5.2) is None
    assert lag_of_answer(ReceivedChallenges(), 100 * SECOND, 5.2) is None


@given(st.lists(st.floats(0.0, 0.5), max_size=200))
def test_no_more_than_the_last_seconds_are_remembered(gaps: list[float]) -> None:
    challenges, now = ReceivedChallenges(), 0.0
    for gap in gaps:
        now += gap
        challenges = note_challenge(challenges, round(now * SECOND), now)
        assert all(now - at <= REMEMBERED for _, at in challenges.received)
        assert challenges.silence(now) == 0.0
