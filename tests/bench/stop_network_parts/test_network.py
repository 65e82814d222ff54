"""Trials count when there is a record of the commands and the computer was free; a trial needs bases at rest."""

from pathlib import Path

import pytest
from bench.stop_network_parts.computer import Computer
from bench.stop_network_parts.lane import GOALS, Lane
from bench.stop_network_parts.network import BUSY, Network, Trial
from bench.stop_network_parts.recorder import Output
from bench.stop_network_parts.verdict import Verdict
from tests.hosts.bench import Machine

LINEAR, GOAL = Lane("rostopic", "linear", 0.5), Lane(GOALS, "linear", 0.5)


class DrivenRobot(Computer):
    """A robot whose plain lanes are driven for ever; it has no programs."""

    def __init__(self) -> None:
        """Boot nothing."""

    def read_outputs(self, lane: Lane, since: float) -> list[Output]:
        """One velocity, just now."""
        return [Output(since + 0.1, lane.speed, 0.0)]


class IdleLaptop(Computer):
    """A laptop that must not be given an order."""

    def __init__(self) -> None:
        """Boot nothing."""
        self.machine = Machine("laptop", "", Path(), "", Path(), 0)


@pytest.mark.parametrize(
    ("recorded", "waited", "counts"),
    [(True, 0.0, True), (True, 2 * BUSY, False), (False, 0.0, False), (False, 2 * BUSY, False)],
)
def test_trial_counts_with_a_record_on_a_free_computer(recorded: bool, waited: float, counts: bool) -> None:
    verdict = Verdict(0.0, 0.0, (), 1.0, recorded)
    assert Trial("kill", LINEAR, "held", verdict, waited, 0, None).counts is counts


def test_trial_does_not_begin_while_a_base_is_driven() -> None:
    running = Network(IdleLaptop(), DrivenRobot(), "magni", [LINEAR, GOAL], 1, patience=0.0)
    with pytest.raises(RuntimeError, match=r"^is not at rest: rostopic_linear$"):
        running.run("kill", "held", lambda _: pytest.fail("it happened"))
