"""The table of a base, and trials that are not as they should be, as text."""

import statistics
from collections.abc import Iterable, Mapping, Sequence

from bench.stop_network_parts.lane import GOALS, Lane
from bench.stop_network_parts.network import Cause, Trial

Results = Mapping[tuple[str, str], Sequence[Trial]]
"""Trials by cause and name of the lane."""


def describe_trial(trial: Trial) -> str:
    """Describe a trial that is not as it should be; empty for one that is."""
    verdict = trial.verdict
    if not verdict.recorded:
        return f"{trial.cause}: {trial.lane.name}, {trial.pattern}: no record of what was sent; not counted"
    if not verdict.ghosts and (verdict.longest <= trial.lane.limit or trial.disturbed):
        return ""
    ghosts = ", ".join(
        f"{ghost.direction} for {ghost.seconds:.2f} s, age {ghost.age:.2f} s, waited for a processor {waited:.2f} s"
        for ghost, waited in zip(verdict.ghosts, trial.ghost_waits, strict=True)
    )
    return (
        f"{trial.cause}: {trial.lane.name}, {trial.pattern}: longest {verdict.longest:.3f} s; "
        f"ghosts: {ghosts or 'none'}; commands recorded: {trial.commands}"
    )


def list_missing(results: Results, causes: Mapping[str, Cause], lanes: Iterable[Lane]) -> list[tuple[str, Lane]]:
    """The causes and lanes of the table for which no trial counts."""
    cells = [(name, lane) for lane in lanes for name, cause in causes.items() if cause.concerns(lane)]
    return [(cause, lane) for cause, lane in cells if not any(each.counts for each in _trials(results, cause, lane))]


def is_fine(results: Results, causes: Mapping[str, Cause], lanes: Sequence[Lane]) -> bool:
    """Return whether every cell has a trial that counts, none moved for too long, and there is no ghost."""
    every = [trial for trials in results.values() for trial in trials]
    return (
        not list_missing(results, causes, lanes)
        and all(trial.verdict.recorded and not trial.verdict.ghosts for trial in every)
        and all(trial.verdict.longest <= trial.lane.limit for trial in every if trial.counts)
    )


def make_table(base: str, results: Results, causes: Mapping[str, Cause], lanes: Sequence[Lane]) -> str:
    """Lay out the results of a base: a line a cause, a column a lane, and the sums."""
    lines = [
        f"{base}: longest motion after the last fresh command in s (at most 0.3; goals: 3.0), ghosts, trials",
        f"{'':28}" + "".join(f"{lane.name:>20}" for lane in lanes) + f"{'moves again':>14}",
    ]
    for name, cause in causes.items():
        cells = [_describe_cell(_trials(results, name, lane)) if cause.concerns(lane) else "-" for lane in lanes]
        again = [each.again for lane in lanes for each in _trials(results, name, lane) if each.again is not None]
        seconds = f"{statistics.median(again):.1f} s" if again and not cause.lost else ""
        lines.append(f"{cause.title:28}" + "".join(f"{cell:>20}" for cell in cells) + f"{seconds:>14}")
    missing = list_missing(results, causes, lanes)
    lines += [f"no trial counts: {causes[cause].title}: {lane.name}" for cause, lane in missing]
    return "\n".join([*lines, _sum_up(base, [trial for trials in results.values() for trial in trials])])


def _describe_cell(trials: Sequence[Trial]) -> str:
    counted = [trial for trial in trials if trial.counts]
    ghosts = sum(len(trial.verdict.ghosts) for trial in trials)
    if not counted:
        return f"NONE / {ghosts} / 0"
    return f"{max(trial.verdict.longest for trial in counted):.3f} / {ghosts} / {len(counted)}"


def _sum_up(base: str, every: Sequence[Trial]) -> str:
    counted = [trial for trial in every if trial.counts and trial.lane.commander != GOALS]
    longest = max((trial.verdict.longest for trial in counted), default=0.0)
    ghosts = sum(len(trial.verdict.ghosts) for trial in every)
    text = f"{base}: {len(counted)} trials, longest {longest:.3f} s, {ghosts} ghosts"
    unrecorded = sum(not trial.verdict.recorded for trial in every)
    if unrecorded:
        text += f"; no record: {unrecorded}"
    busy = [trial.verdict.longest for trial in every if trial.verdict.recorded and trial.disturbed]
    return text + (f"; made again, on a busy computer: {len(busy)}, longest {max(busy):.3f} s" if busy else "")


def _trials(results: Results, cause: str, lane: Lane) -> Sequence[Trial]:
    return results.get((cause, lane.name), ())
