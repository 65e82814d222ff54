"""The table of the bench: every cause and lane needs a trial that counts, and a ghost is printed with its direction."""

from collections import defaultdict

import pytest
from bench.stop_network_parts.causes import CAUSES as ALL
from bench.stop_network_parts.lane import LEASED, Lane
from bench.stop_network_parts.network import BUSY, Trial
from bench.stop_network_parts.table import Results, describe_trial, is_fine, list_missing, make_table
from bench.stop_network_parts.verdict import Ghost, Verdict

KEYBOARD, ROSTOPIC = Lane("keyboard", "linear", 0.5), Lane("rostopic", "linear", 0.5)
LANES, CAUSES = (KEYBOARD, ROSTOPIC), {name: ALL[name] for name in ("cut", "second")}
GOOD = Verdict(0.25, 1.0, (), 1.0)
GHOST = Verdict(0.25, 1.0, (Ghost(5.0, 0.4, 18.0, "back"),), 1.0)


def trial(cause: str, lane: Lane, verdict: Verdict = GOOD, waited: float = 0.0) -> Trial:
    return Trial(cause, lane, "held", verdict, waited, 9, None, (0.0,) * len(verdict.ghosts))


def results_of(*trials: Trial) -> Results:
    found = defaultdict(list)
    for each in trials:
        found[each.cause, each.lane.name].append(each)
    return found


def test_cause_that_some_commanders_have_no_part_in_needs_no_trial_of_theirs() -> None:
    assert ROSTOPIC.commander not in LEASED
    results = results_of(trial("cut", KEYBOARD), trial("cut", ROSTOPIC), trial("second", KEYBOARD))
    assert is_fine(results, CAUSES, LANES)
    assert list_missing(results, CAUSES, LANES) == []
    assert "NONE" not in make_table("magni", results, CAUSES, LANES)


@pytest.mark.parametrize(
    "left", [(), (trial("cut", ROSTOPIC, waited=2 * BUSY),), (trial("cut", ROSTOPIC, Verdict(0, 0, (), 1, False)),)]
)
def test_cell_without_a_trial_that_counts_fails_and_is_printed(left: tuple[Trial, ...]) -> None:
    results = results_of(trial("cut", KEYBOARD), trial("second", KEYBOARD), *left)
    assert not is_fine(results, CAUSES, LANES)
    assert list_missing(results, CAUSES, LANES) == [("cut", ROSTOPIC)]
    table = make_table("magni", results, CAUSES, LANES)
    assert "no trial counts: cut and restored: rostopic_linear" in table
    (row,) = [line for line in table.splitlines() if line.startswith("cut and restored")]
    assert "NONE / 0 / 0" in row


def test_bench_without_any_trial_fails() -> None:
    assert not is_fine({}, CAUSES, LANES)
    assert make_table("magni", {}, CAUSES, LANES).count("no trial counts") == 3


@pytest.mark.parametrize("bad", [trial("cut", ROSTOPIC, GHOST), trial("cut", ROSTOPIC, Verdict(0.31, 1.0, (), 1.0))])
def test_ghost_or_long_motion_fails_though_other_trials_are_fine(bad: Trial) -> None:
    good = (trial("cut", KEYBOARD), trial("cut", ROSTOPIC), trial("second", KEYBOARD))
    assert not is_fine(results_of(*good, bad), CAUSES, LANES)


def test_ghost_is_described_with_its_direction() -> None:
    assert "ghosts: back for 0.40 s, age 18.00 s" in describe_trial(trial("cut", ROSTOPIC, GHOST))
    assert describe_trial(trial("cut", ROSTOPIC)) == ""
