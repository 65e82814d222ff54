"""All trials on ROS 2, and their table."""

import os
import shutil
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
from bench.stop_network_parts.ros2.network import LANES, PYTHON, Network, start_network
from bench.stop_network_parts.table import describe_trial, is_fine, make_table

Results = dict[tuple[str, str], list[Trial]]
_ROUNDS = 2  # times as many trials as asked for, at most, where some are disturbed
_MORE = 1.05  # of the printed way
_HALVES = 2  # networks: with multicast, and without


def run_ros2(base: str, causes: Sequence[str], trials: int, seconds: float, seed: int, speed: float = 0.0) -> int:
    """Make the trials of a base, and print their table. Returns 1 when a motion was too long, or a ghost."""
    if problem := _find_obstacle():
        sys.stderr.write(f"error: no computers to measure with: {problem}\n")
        return 2
    results: Results = defaultdict(list)
    way, lanes = 0.0, LANES
    end = time.monotonic() + seconds
    for half in range(_HALVES):
        share = (trials + half) // _HALVES
        until = end - (seconds / _HALVES if half == 0 and seconds < float("inf") else 0.0)
        with tempfile.TemporaryDirectory(prefix="ur-stop-") as folder:
            try:
                with start_network(Path(folder), base, seed + half, speed, multicast=half == 0) as network:
                    _run_all(network, causes, share, until, results)
                    way, lanes = network.base.limits.way_to_rest, network.lanes
            except RuntimeError as problem:
                print(f"{base}: the trials broke off: {problem}", flush=True)
                _print_logs(Path(folder))
    chosen = {name: CAUSES[name] for name in causes}
    print(f"\n{make_table(f'{base} on ROS 2', results, chosen, lanes)}", flush=True)
    counted = [trial.verdict.way for made in results.values() for trial in made if trial.counts]
    longest = max(counted, default=0.0)
    print(f"longest way after the last fresh command: {longest:.3f} m, printed for the base: {way:.3f} m", flush=True)
    return 0 if is_fine(results, chosen, lanes) and (not speed or longest <= _MORE * way) else 1


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
