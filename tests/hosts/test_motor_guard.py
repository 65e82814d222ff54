"""Motors rest soon after what drives them is killed, whoever starts the drivers, on a booted robot."""

from collections.abc import Iterator

import pytest
from bench.motor_guard_parts.robot import LIMIT, STARTERS, USERS, boot_robot, run_trials
from tests.hosts.bench import Machine

SETS = ("host", "guard", "host+guard", "guard+ur", "cgroup", "unit", "host+driver+ur+cgroup+unit")
_ATTEMPTS = 3  # where this computer is too busy to measure


@pytest.fixture(scope="module")
def robot() -> Iterator[Machine]:
    with boot_robot() as running:
        yield running


@pytest.mark.parametrize("user", USERS)
@pytest.mark.parametrize("starter", STARTERS)
def test_boards_rest_whichever_processes_of_their_drivers_are_killed(robot: Machine, user: str, starter: str) -> None:
    late: dict[str, object] = dict.fromkeys(SETS)
    for _ in range(_ATTEMPTS):
        trials = list(run_trials(robot, user, starter, 1, tuple(late)))
        driven_on = {trial.chosen: trial.rest for trial in trials if None in trial.rest.values()}
        assert not driven_on
        late = {trial.chosen: trial.rest for trial in trials if trial.longest > LIMIT}
        if not late:
            break
    assert not late
