"""One log through the node's tracker, scan by scan, in a process of its own, so that its memory is the mapper's."""

import multiprocessing
import time
from dataclasses import dataclass
from multiprocessing.connection import Connection

import numpy as np
from bench.mapping_parts.log import Floats, Log
from bench.mapping_parts.measure import peak_memory
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount
from ur_nodes.slam.matching.scan import make_scan
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.tracker import MapTracker

_MAP_EVERY = 5.0  # s between two drawings of the map, as a node has it


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """Paths (n, 3): the final one, and each pose as it was reported at once; nan where the robot's place was unknown.

    `seconds` (n) is the CPU time of each scan, `lost` (n) the scans after which the robot counted as lost. `drawing` is
    the CPU time in s of all drawings of the map but the last, `memory` in MB the most of the process.
    """

    path: Floats
    live: Floats
    seconds: Floats
    lost: NDArray[np.bool_]
    drawing: float
    memory: float
    grid: Grid
    keyframes: int
    loops: int


def run_apart(log: Log, *, odometry: bool = True) -> Result:
    """Map a log in a fresh process."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    arguments = (there, log.directions, SensorMount(np.eye(3), np.array((*log.mount[:2], 0.0))), log.range_limits)
    mapper = context.Process(target=_run, args=arguments)
    mapper.start()
    there.close()
    for stamp, ranges, pose in zip(log.stamps, log.ranges, log.odometry, strict=True):
        here.send((float(stamp), ranges, Pose2(*pose) if odometry else None))
    here.send(None)
    result: Result = here.recv()
    mapper.join()
    return result


def _run(pipe: Connection, directions: Floats, mount: SensorMount, limits: tuple[float, float]) -> None:
    """Map what comes through a pipe until None comes, then answer with the result."""
    tracker, drawn = MapTracker(), OccupancyMap()
    seconds: list[float] = []
    live: list[tuple[float, ...]] = []
    lost: list[bool] = []
    drawing, due = 0.0, -np.inf
    while (received := pipe.recv()) is not None:
        stamp, ranges, odometry = received
        began = time.process_time()
        scan = make_scan(ranges, directions, limits, mount)
        estimate = tracker.add_scan(scan, odometry)
        seconds.append(time.process_time() - began)
        lost.append(tracker.lost)
        live.append((np.nan, np.nan, np.nan) if tracker.lost else tuple(estimate.pose))
        if stamp >= due:
            due = stamp + _MAP_EVERY
            began = time.process_time()
            drawn.update(tracker.keyframes, tracker.scans, tracker.drives())
            drawing += time.process_time() - began
    drawn.update(tracker.keyframes, tracker.scans, tracker.drives())
    path = np.full((len(live), 3), np.nan)
    for number, pose in tracker.path().items():
        path[number] = pose
    memory = peak_memory()
    pipe.send(
        Result(
            path,
            np.array(live),
            np.array(seconds),
            np.array(lost, np.bool_),
            drawing,
            memory,
            drawn.grid(),
            len(tracker.scans),
            tracker.loops,
        )
    )
