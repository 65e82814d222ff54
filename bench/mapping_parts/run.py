"""One log through the mapper, in a process of its own, so that its memory is its own."""

from __future__ import annotations

import multiprocessing
import resource
import time
from dataclasses import dataclass

import numpy as np
from bench.mapping_parts.log import Floats, Log

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.slam.mapper import Mapper
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.scan import make_scan

_MAP_EVERY = 5.0  # s between two drawings of the map, as a node has it


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """Paths (n, 3): the final one, and each pose as it was reported at once. `seconds` (n): CPU time of each scan.

    `drawing` is the CPU time in s of all drawings of the map but the last, `memory` in MB the most of the process.
    """

    path: Floats
    live: Floats
    seconds: Floats
    drawing: float
    memory: float
    grid: Grid
    keyframes: int
    loops: int


def run_apart(log: Log, *, odometry: bool = True) -> Result:
    """Map a log in a fresh process."""
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        result: Result = pool.apply(_run, (log, odometry))
    return result


def _run(log: Log, odometry: bool) -> Result:
    mapper, drawn = Mapper(), OccupancyMap()
    live, seconds, drawing = [], [], 0.0
    directions, offset = log.directions, np.array(log.mount[:2])
    due = log.stamps[0]
    for number in range(len(log)):
        began = time.process_time()
        scan = make_scan(log.ranges[number], directions, log.range_limits, np.eye(2), offset)
        estimate = mapper.add_scan(scan, Pose2(*log.odometry[number]) if odometry else None)
        seconds.append(time.process_time() - began)
        live.append(estimate.pose)
        if log.stamps[number] >= due:
            due = log.stamps[number] + _MAP_EVERY
            began = time.process_time()
            drawn.update(mapper.keyframes, mapper.scans)
            drawing += time.process_time() - began
    drawn.update(mapper.keyframes, mapper.scans)
    return Result(
        np.array(mapper.path()),
        np.array(live),
        np.array(seconds),
        drawing,
        resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e3,
        drawn.grid(),
        len(mapper.scans),
        mapper.loops,
    )
