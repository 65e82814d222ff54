"""The times of beams that a lidar gives as a table of its last turn."""

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.base_contract import load

from ur_nodes.drivers.lidars.turns import TurnCollector
from ur_nodes.drivers.readings import MeasuredBeams
from ur_nodes.ports.values import Scan

BEAMS = 360
RATE = 5.0
BEGUN = 1_000_000_000  # ns
STEP = 0.001  # m from one turn to the next: the distance of a beam tells in which it was measured


class Table:
    """What a head that turns has measured last in each direction; it is where it is due at the beginning."""

    def __init__(self, *, wall: int = BEAMS, noise: int = 0) -> None:
        """`wall`: the beams from 0 on that find one. `noise`: beams of an answer that are damaged."""
        self._wall, self._noise, self._random = wall, noise, np.random.default_rng(7)
        self._passed = 0
        self._ranges = np.full(BEAMS, np.inf)

    def read(self, seconds: float) -> MeasuredBeams:
        """The table at a time since the beginning."""
        for beam in range(self._passed, int(seconds * RATE * BEAMS + 1e-6)):
            self._ranges[beam % BEAMS] = 1.0 + STEP * (beam // BEAMS) if beam % BEAMS < self._wall else np.inf
            self._passed = beam + 1
        ranges = self._ranges.copy()
        ranges[self._random.choice(BEAMS, self._noise, replace=False)] = self._random.random(self._noise) + 5.0
        return MeasuredBeams(np.radians(np.arange(BEAMS)), ranges, np.zeros(BEAMS), turn_time=1.0 / RATE, complete=True)


def collect(table: Table, period: float, seconds: float = 4.0) -> list[Scan]:
    """The scans of tables that are read so often, but for those of the first second."""
    lidar = load("botvac", "").lidar
    assert lidar
    collector, scans = TurnCollector(lidar), list[Scan]()
    for at in np.arange(0.33, seconds, period):
        found = collector.add(table.read(at), BEGUN + round(at * 1e9))
        scans += found if at > 1.0 else []
    return scans


def late(scan: Scan) -> NDArray[np.float64]:
    """How much later (s) than it was measured each beam is said to be, for those that found the wall."""
    there = np.flatnonzero(scan.ranges < 5.0)
    measured = (np.rint((scan.ranges[there] - 1.0) / STEP) + (there + 1.0) / BEAMS) / RATE
    said = (scan.stamp - BEGUN) / 1e9 + there * scan.time_increment
    errors: NDArray[np.float64] = said - measured
    return errors


@pytest.mark.parametrize("period", [0.1, 0.07, 0.15])
def test_beams_have_the_times_at_which_the_head_passed_them(period: float) -> None:
    scans = collect(Table(), period)
    assert len(scans) >= 13
    assert all(np.abs(late(scan)).max() < 0.002 for scan in scans)


def test_head_is_followed_where_most_beams_find_nothing() -> None:
    scans = collect(Table(wall=90), 0.1)
    assert len(scans) >= 13
    assert all(np.abs(late(scan)).max() < 0.005 for scan in scans)


def test_damaged_rows_move_the_head_by_a_beam_at_most() -> None:
    scans = collect(Table(noise=7), 0.1)
    assert len(scans) >= 13
    assert all(np.count_nonzero(np.abs(late(scan)) > 0.002) <= 2 for scan in scans)


def test_table_that_is_read_once_a_turn_is_half_a_turn_old_on_average() -> None:
    scans = collect(Table(), 0.2)
    assert len(scans) >= 13
    assert all(scan.time_increment == 0.0 for scan in scans)
    assert all(np.abs(late(scan)).max() < 0.11 for scan in scans)


def test_table_that_does_not_change_is_still_published() -> None:
    lidar = load("botvac", "").lidar
    assert lidar
    collector, table = TurnCollector(lidar), Table()
    still = table.read(1.0)
    scans = [scan for k in range(10) for scan in collector.add(still, BEGUN + k * 100_000_000)]
    assert len(scans) == 10
