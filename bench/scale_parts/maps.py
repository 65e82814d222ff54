"""Large maps: planning, memory of map_server, amcl and move_base, and the time to the first goal."""

import json
import math
import subprocess
import sys
import time
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
from bench.scale_parts.rows import Row

SIZES = (500, 1000, 2000, 4000)
SIZE = "cells of the map (those of a side squared), or m of the way"
PEER = ""
WAYS = (15.0, 30.0, 75.0, 150.0)
_ROOT = Path(__file__).resolve().parents[2]
_TRIALS, _LONG_TRIALS = 20, 10
_NODES = ("map_server", "amcl", "move_base")


def measure(sizes: Sequence[int]) -> Iterator[Row]:
    """Measure maps of `sizes` cells a side, and ways of several lengths on the largest."""
    for side in sizes:
        yield from measure_nodes(side)
    for side in sizes:
        yield from measure_plans(side, (15.0,), f"maps: plan {15:g} m, p95", by_way=False)
    yield from measure_plans(max(sizes), WAYS, f"maps: plan on {max(sizes)}^2 by m of way, p95", by_way=True)


def measure_nodes(side: int) -> Iterator[Row]:
    """Start the three nodes on one map; in a process of its own, as rospy starts only once in one."""
    command = [sys.executable, "-m", "bench.scale_parts.map_nodes", str(side)]
    done = subprocess.run(command, cwd=_ROOT, capture_output=True, text=True, check=False, timeout=400)
    if done.returncode:
        raise SystemExit(f"error: nodes on {side} x {side} cells: {done.stderr[-2000:]}")
    figures = json.loads(done.stdout.splitlines()[-1])
    size = float(side * side)
    yield Row("maps: first goal accepted", size, figures["accepted"], "s")
    yield Row("maps: first path", size, figures["plan"], "s")
    yield Row("maps: processor until then and 3 s", size, sum(figures[node]["cpu"] for node in _NODES), "s")
    for kind in ("pss", "rss", "peak"):
        for node in _NODES:
            yield Row(f"maps: {node} {kind}", size, figures[node][kind], "MB")
        yield Row(f"maps: all three {kind}", size, sum(figures[node][kind] for node in _NODES), "MB")


def measure_plans(side: int, ways: Iterable[float], subject: str, *, by_way: bool) -> Iterator[Row]:
    """Time plans between random places with room, straight distances `ways` m; processor time of the 95th per cent."""
    from bench.scale_parts.building import RESOLUTION, make_building

    from ur_nodes.costmap.costmap import Costmap, Inflation, costs_of_grid, inflate
    from ur_nodes.geometry.grid import Grid
    from ur_nodes.geometry.pose import Pose2
    from ur_nodes.navigation.planning.global_plan import NoPathError, PlanSettings, plan_path

    grid = Grid(make_building(side), RESOLUTION, Pose2(-side * RESOLUTION / 2, -side * RESOLUTION / 2, 0.0))
    inflation = Inflation(0.2, 0.55, 25.0)
    costs = inflate(costs_of_grid(grid, lethal=65), RESOLUTION, inflation)
    costmap = Costmap(costs, RESOLUTION, grid.origin)
    settings = PlanSettings(nudge=0.048, room=0.31)
    for way in ways:
        trials = _LONG_TRIALS if way > 50.0 else _TRIALS
        times = []
        for start, goal in _pairs(costmap, way, trials):
            began = time.process_time()
            try:
                plan_path(costmap, start, goal, settings)
            except NoPathError as problem:
                if "nothing wide enough" not in str(problem):
                    raise
            times.append(time.process_time() - began)
        if times:
            yield Row(subject, way if by_way else float(side * side), float(np.quantile(times, 0.95)), "s")


def _pairs(costmap, way: float, count: int) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:  # type: ignore[no-untyped-def]
    rng = np.random.default_rng(7)
    left, bottom, right, top = costmap.bounds
    if way > 1.2 * min(right - left, top - bottom):
        return
    while count:
        start = rng.uniform((left, bottom), (right, top))
        angle = rng.uniform(-math.pi, math.pi)
        goal = start + way * np.array((math.cos(angle), math.sin(angle)))
        if (costmap.costs_at(np.stack((start, goal))) == 0).all():
            count -= 1
            yield (float(start[0]), float(start[1])), (float(goal[0]), float(goal[1]))
