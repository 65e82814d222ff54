"""All trials on ROS 2, and their table."""

from __future__ import annotations

import os
import shutil
import statistics
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from bench.stop_network_parts.lane import PATTERNS
from bench.stop_network_parts.network import Trial
from bench.stop_network_parts.ros2.causes import CAUSES
from bench.stop_network_parts.ros2.network import LANES, MOTORS, PYTHON, Network, start_network
from bench.stop_network_parts.table import describe_trial

Results = dict[tuple[str, str], list[Trial]]
_ROUNDS = 2  # times as many trials as asked for, at most, where some are disturbed
_HALVES = 2  # networks: with multicast, and without


def run_ros2(base: str, causes: Sequence[str], trials: int, seconds: float, seed: int) -> int:
    """Make the trials of a base, and print their table. Returns 1 when a motion was too long, or a ghost."""
    if problem := _find_obstacle():
        sys.stderr.write(f"error: no computers to measure with: {problem}\n")
        return 2
    results: Results = defaultdict(list)
    end = time.monotonic() + seconds
    for half in range(_HALVES):
        share = (trials + half) // _HALVES
        until = end - (seconds / _HALVES if half == 0 and seconds < float("inf") else 0.0)
        with tempfile.TemporaryDirectory(prefix="ur-stop-") as folder:
            try:
                with start_network(Path(folder), base, seed + half, multicast=half == 0) as network:
                    _run_all(network, causes, share, until, results)
            except RuntimeError as problem:
                print(f"{base}: the trials broke off: {problem}", flush=True)
                _print_logs(Path(folder))
    print(f"\n{make_table(base, results, causes)}", flush=True)
    every = [trial for made in results.values() for trial in made]
    fine = all(trial.verdict.recorded and not trial.verdict.ghosts for trial in every)
    fine = fine and all(trial.verdict.longest <= trial.lane.limit for trial in every if trial.counts)
    return (
        0 if fine and all(any(t.counts for t in results[cause, lane.name]) for cause in causes for lane in LANES) else 1
    )


def _run_all(network: Network, causes: Sequence[str], trials: int, end: float, results: Results) -> None:
    made: dict[str, int] = defaultdict(int)
    for turn in range(trials * _ROUNDS):
        for cause in causes:
            if time.monotonic() > end:
                return
            if made[cause] >= trials:
                continue
            found = CAUSES[cause]
            pattern = network.chance.choice(list(PATTERNS))
            tried = network.run(cause, pattern, found.happen)
            made[cause] += all(trial.counts for trial in tried)
            for trial in tried:
                results[cause, trial.lane.name].append(trial)
                if text := describe_trial(trial):
                    print(text, flush=True)
            print(f"{'multicast' if network.multicast else 'peers only'}, turn {turn + 1}: {cause}", flush=True)
            if found.lost:
                network.start_commanders()


def make_table(base: str, results: Results, causes: Sequence[str]) -> str:
    """The longest motion after the last fresh command, ghosts and trials by cause and lane."""
    titles = [f"{name} ({'TwistStamped' if kind == 'stamped' else 'Twist'} base)" for name, kind in MOTORS.items()]
    lines = [
        f"{base} on ROS 2: longest motion after the last fresh command in s (at most 0.3), ghosts, trials that count",
        f"{'':28}" + "".join(f"{title:>28}" for title in titles),
    ]
    total = ghosts = 0
    for cause in causes:
        cells = []
        for lane in LANES:
            counted = [trial for trial in results[cause, lane.name] if trial.counts]
            found = sum(len(trial.verdict.ghosts) for trial in results[cause, lane.name])
            total, ghosts = total + len(counted), ghosts + found
            longest = [trial.verdict.longest for trial in counted]
            cells.append(f"{max(longest):.3f}, {found}, {len(counted)}" if counted else f"NONE, {found}, 0")
        lines.append(f"{CAUSES[cause].title:28}" + "".join(f"{cell:>28}" for cell in cells))
    longest = [trial.verdict.longest for made in results.values() for trial in made if trial.counts]
    if longest:
        middle = statistics.median(longest)
        lines.append(f"{total} trials, {ghosts} ghosts; longest motion {max(longest):.3f} s, median {middle:.3f} s")
    return "\n".join(lines)


def _print_logs(folder: Path) -> None:
    for log in sorted(folder.glob("*.txt")):
        text = log.read_text(errors="replace").splitlines()[-5:]
        print("\n".join([f"--- {log.name}", *text]), flush=True)


def _find_obstacle() -> str:
    if os.geteuid() != 0:
        return "needs root, expected sudo"
    missing = [each for each in ("ip", "nsenter", "unshare", "gcc") if not shutil.which(each)]
    if missing:
        return f"{', '.join(missing)} not installed"
    if not PYTHON.exists():
        return f"{PYTHON} is missing, the wheels of ROS 2; run: bash tools/set_up.bash test"
    return "" if find_spec("cyclonedds") else "the package cyclonedds is not installed"
