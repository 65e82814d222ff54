import pytest

from ur_nodes.client.patrol_text import PatrolAction, PatrolRequest
from ur_nodes.missions.robot.patrol_runner import refuse_request
from ur_nodes.motion.lease.text import FREE, Lease
from ur_nodes.navigation.goals.goal_claim import ReceivedChallenges, note_challenge

HEARD = note_challenge(note_challenge(ReceivedChallenges(), 7_000_000_000, 50.0), 9_000_000_000, 52.0)
OTHERS = Lease("held", "laptop-1", "laptop", since=1.8e9)
OWN = Lease("held", "patrol", "patrol")


def refuse(
    lease: Lease | None,
    *,
    answers: tuple[int, int] | None = (9, 0),
    action: PatrolAction = "start",
    latched: bool = False,
) -> str:
    request = PatrolRequest(action, client="page-1" if answers else "", answers=answers)
    return refuse_request(request, lease, "patrol", HEARD, 52.5, latched=latched)


@pytest.mark.parametrize("lease", [None, FREE, OWN, Lease("held", "page-1", "phone"), Lease("lost", "page-1", "phone")])
def test_young_request_is_accepted_where_nobody_else_drives(lease: Lease | None) -> None:
    assert refuse(lease) == ""


@pytest.mark.parametrize("answers", [(9, 0), None])
def test_request_is_refused_while_another_client_drives(answers: tuple[int, int] | None) -> None:
    assert refuse(OTHERS, answers=answers).startswith("laptop drives since ")
    assert "out of reach, take over first" in refuse(Lease("lost", "laptop-1", "laptop"), answers=answers)


@pytest.mark.parametrize("action", ["start", "resume"])
def test_late_request_sets_nothing_in_motion(action: PatrolAction) -> None:
    assert refuse(FREE, answers=(7, 0), action=action) == "the request arrived late (2.5 s), send it again"
    assert refuse(FREE, answers=(1, 0), action=action).startswith("the request arrived late")


def test_request_without_a_challenge_must_not_be_latched() -> None:
    assert refuse(FREE, answers=None) == ""
    assert "latched" in refuse(FREE, answers=None, latched=True)
    assert refuse(FREE, latched=True) == ""  # the challenge proves its age


@pytest.mark.parametrize("action", ["pause", "end"])
def test_pause_and_end_count_however_late_and_whoever_asks(action: PatrolAction) -> None:
    assert refuse(OTHERS, answers=(1, 0), action=action, latched=True) == ""
