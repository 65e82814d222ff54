"""A long drive over the same rooms, for what grows with time: memory, the time of a scan, and that of a loop."""

import math
import multiprocessing
import time
from collections.abc import Iterator
from dataclasses import dataclass
from multiprocessing.connection import Connection

import numpy as np
from bench.mapping_parts.log import Floats
from bench.mapping_parts.measure import peak_memory
from bench.mapping_parts.simulated import Moment, drive, grid_of_world, read_bench_world

from ur.robot.base import Base
from ur_nodes.geometry.pose import Pose2
from ur_nodes.geometry.scan import SensorMount
from ur_nodes.simulator.simulation import Simulation
from ur_nodes.slam.matching.scan import make_scan
from ur_nodes.slam.occupancy import OccupancyMap
from ur_nodes.slam.tracker import MapTracker

_MAP_EVERY = 5.0  # s


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """The mapper so far: `memory` in MB, `keyframes`, `links`; CPU times (n) in s of scans and drawings since."""

    memory: float
    keyframes: int
    links: int
    scans: Floats
    drawings: Floats


@dataclass(frozen=True, slots=True, eq=False)
class LongDrive:
    """The parts of a drive, `way` in m, and the live and true poses (n, 3); nan where the robot's place was unknown."""

    parts: tuple[Part, ...]
    way: float
    live: Floats
    truth: Floats


def drive_long(name: str, seed: int, base: Base, minutes: float, report: float) -> Iterator[LongDrive]:
    """Drive for so long among the goals of a world, in an order drawn at random; yields after each `report` minutes."""
    assert base.lidar is not None
    world, goals = read_bench_world(name, seed)
    random = np.random.default_rng(seed)
    endless = (goals[index] for _ in range(10_000) for index in random.permutation(len(goals)))
    moments = drive(Simulation(world, base, seed=seed), base, grid_of_world(world), endless)
    lidar = base.lidar
    angles = np.linspace(lidar.angle_min, lidar.angle_max, lidar.samples)
    mount = Pose2(lidar.pose[0], lidar.pose[1], lidar.pose[5])
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    mapper = context.Process(target=_map, args=(there, angles, mount, (lidar.range_min, lidar.range_max)))
    mapper.start()
    parts: list[Part] = []
    live: list[tuple[float, float, float]] = []
    truth: list[Pose2] = []
    way, due = 0.0, 60.0 * report
    for moment in moments:
        here.send(moment)
        live.append(here.recv())
        way += math.dist(moment.truth[:2], truth[-1][:2]) if truth else 0.0
        truth.append(moment.truth)
        if moment.stamp >= due or moment.stamp >= 60.0 * minutes:
            due += 60.0 * report
            here.send(None)
            parts.append(here.recv())
            yield LongDrive(tuple(parts), way, np.array(live), np.array(truth))
        if moment.stamp >= 60.0 * minutes:
            break
    here.close()
    mapper.join()


def _map(pipe: Connection, angles: Floats, mount: Pose2, limits: tuple[float, float]) -> None:
    """Map what comes through a pipe, and answer with live poses; None asks for a Part."""
    directions = np.column_stack((np.cos(angles), np.sin(angles)))
    level = SensorMount(np.eye(3), np.array((*mount[:2], 0.0)))
    tracker, drawn = MapTracker(), OccupancyMap()
    scans: list[float] = []
    drawings: list[float] = []
    due = 0.0
    while True:
        try:
            moment: Moment | None = pipe.recv()
        except EOFError:
            return
        if moment is None:
            memory = peak_memory()
            pipe.send(Part(memory, len(tracker.scans), tracker.loops, np.array(scans), np.array(drawings)))
            scans.clear()
            drawings.clear()
            continue
        began = time.process_time()
        scan = make_scan(moment.ranges, directions, limits, level)
        estimate = tracker.add_scan(scan, moment.odometry)
        scans.append(time.process_time() - began)
        if moment.stamp >= due:
            due = moment.stamp + _MAP_EVERY
            began = time.process_time()
            drawn.update(tracker.keyframes, tracker.scans, tracker.drives())
            drawn.grid()
            drawings.append(time.process_time() - began)
        pipe.send((math.nan, math.nan, math.nan) if tracker.lost else tuple(estimate.pose))
