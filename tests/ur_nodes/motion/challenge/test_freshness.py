"""Challenges: ages of answers by the issuer's clock alone."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.motion.challenge.freshness import NO_STAMP, IssuedChallenges, Stamp, age_of, issue


def issue_all(times: list[float], offset: int = 1) -> tuple[IssuedChallenges, list[Stamp]]:
    challenges, stamps = IssuedChallenges(offset), []
    for at in times:
        challenges, stamp = issue(challenges, at)
        stamps.append(stamp)
    return challenges, stamps


def test_age_counts_from_the_issue_of_the_challenge() -> None:
    challenges, (first, second) = issue_all([10.0, 10.02])
    assert age_of(challenges, first, 10.05) == pytest.approx(0.05)
    assert age_of(challenges, second, 10.05) == pytest.approx(0.03)


def test_answer_has_no_age_after_the_limit() -> None:
    challenges, (first,) = issue_all([10.0])
    assert age_of(challenges, first, 10.1499) is not None
    assert age_of(challenges, first, 10.1501) is None
    assert age_of(challenges, first, 10.5, limit=1.0) == pytest.approx(0.5)


def test_answer_that_was_never_issued_has_no_age() -> None:
    challenges, ((seconds, nanoseconds),) = issue_all([10.0])
    for stamp in (NO_STAMP, (seconds, nanoseconds + 1), (seconds + 1, nanoseconds), (2**32 - 1, 0)):
        assert age_of(challenges, stamp, 10.0) is None


def test_answer_from_before_time_went_back_has_no_age() -> None:
    challenges, (first,) = issue_all([10.0])
    assert age_of(challenges, first, 9.0) is None


def test_restarted_issuer_does_not_know_the_challenges_of_the_one_before() -> None:
    _, stamps = issue_all([10.0, 10.02, 10.04], offset=5_000_000_000)
    challenges, _ = issue_all([10.06, 10.08], offset=7_000_000_000)
    assert [age_of(challenges, stamp, 10.1) for stamp in stamps] == [None, None, None]


@pytest.mark.parametrize("offset", [0, -1, 2**32 * 10**9])
def test_offset_without_room_is_refused(offset: int) -> None:
    with pytest.raises(ValueError, match="offset"):
        IssuedChallenges(offset)


@given(st.lists(st.floats(0.0, 1e6), max_size=60), st.integers(1, 2**60))
def test_no_challenge_is_issued_twice_and_few_are_kept(times: list[float], offset: int) -> None:
    challenges, stamps = issue_all(times, offset)
    assert len(set(stamps)) == len(stamps)
    assert NO_STAMP not in stamps
    assert all(0 <= seconds < 2**32 and 0 <= nanoseconds < 10**9 for seconds, nanoseconds in stamps)
    assert all(abs(times[-1] - at) <= challenges.horizon for at in challenges.issued.values())
