"""Figures for people."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from bench.navigation_parts.comfort import FREEZE, NEAR, Comfort
from bench.navigation_parts.driver import Drive
from bench.navigation_parts.explored import ExploredMap
from bench.navigation_parts.stack import Usage
from bench.navigation_parts.worlds import Goal

CLOSEST = 0.25  # m to people while the robot moves


def print_explored(world: str, explored: ExploredMap) -> None:
    """One line for the map that a robot has made; its pose in the world, and the distance of its walls."""
    pose = explored.pose
    print(
        f"{world}: explored map at ({pose.x:.3f}, {pose.y:.3f}) m, {math.degrees(pose.yaw):.2f} deg in the world,"
        f" walls {explored.error:.3f} m rms from true ones",
        flush=True,
    )


def print_drive(number: int, goal: Goal, drive: Drive, speed: float) -> None:
    """One line for one goal; `speed` is that of the base, m/s."""
    outcome = "reached" if drive.reached else f"FAILED: {drive.text}"
    worst = max(drive.errors, default=0.0)
    mean = sum(drive.errors) / max(1, len(drive.errors))
    print(
        f"  {number + 1:2} ({goal[0]:6.2f} {goal[1]:6.2f} {goal[2]:5.0f})  {outcome}  {drive.length:5.1f} m"
        f"  path {drive.length / drive.shortest:.3f}  time {ratio(drive.seconds, drive.length, speed):.3f}"
        f"  final {drive.error:.3f} m {drive.turn_error:.1f} deg  localisation {mean:.3f} {worst:.3f} m",
        flush=True,
    )


def print_report(
    world: str,
    drives: Sequence[Drive],
    collisions: int | None,
    before: Mapping[str, Usage],
    after: Mapping[str, Usage],
    seconds: float,
    speed: float,
) -> bool:
    """The figures of one world; whether all goals were reached and nothing was touched."""
    reached = sum(drive.reached for drive in drives)
    length = sum(drive.length for drive in drives)
    errors = [error for drive in drives for error in drive.errors]
    print(f"{world}: reached {reached} of {len(drives)}")
    print(f"  path          {length / sum(drive.shortest for drive in drives):.3f}")
    print(f"  time          {ratio(sum(drive.seconds for drive in drives), length, speed):.3f}")
    print(f"  final error   {_mean_worst([d.error for d in drives], 'm', 3)}")
    print(f"                {_mean_worst([d.turn_error for d in drives], 'deg', 1)}")
    print(f"  localisation  {_mean_worst(errors, 'm', 3)}")
    print(f"  collisions    {'not reported by this simulator' if collisions is None else collisions}")
    total = memory = 0.0
    for name, usage in after.items():
        share = 100.0 * (usage.cpu - before[name].cpu if name in before else usage.cpu) / seconds
        total += 0.0 if name == "(master)" else share
        memory += 0.0 if name == "(master)" else usage.memory
        print(f"  {name:22} {share:5.1f} % of a core  {usage.memory:6.1f} MB")
    print(f"  {'all nodes':22} {total:5.1f} % of a core  {memory:6.1f} MB", flush=True)
    return reached == len(drives) and not collisions


def print_comfort(comfort: Comfort, lost: int) -> bool:
    """The figures of people, and how often the robot was taken for lost; whether it kept its distance and was not."""
    print(f"  people        {comfort.closest:.2f} m of room at least while it moves, less than {NEAR:g} m for")
    print(f"                {comfort.near:.1f} s of {comfort.seconds:.0f} s; {comfort.freezes} rests of {FREEZE:g} s,")
    print(f"                {comfort.strikes} contacts that the robot caused")
    print(f"  lost          {lost} times", flush=True)
    return not comfort.strikes and comfort.closest >= CLOSEST and not lost


def write_figures(
    file: Path, world: str, drives: Sequence[Drive], collisions: int | None, moved: int, breaches: Sequence[str]
) -> None:
    """Add the figures of one world to a file, as a line of JSON."""
    shortest = sum(drive.shortest for drive in drives)
    figures = {
        "world": world,
        "goals": len(drives),
        "reached": sum(drive.reached for drive in drives),
        "moved": moved,
        "path": sum(drive.length for drive in drives) / shortest if shortest else 0.0,
        "final_error": max((drive.error for drive in drives if drive.reached), default=0.0),
        "collisions": collisions or 0,
        "breaches": list(breaches),
        "failures": [drive.text for drive in drives if not drive.reached],
    }
    with file.open("a", encoding="utf-8") as opened:
        opened.write(json.dumps(figures) + "\n")


def ratio(seconds: float, length: float, speed: float) -> float:
    """Time over the time that the length takes at full speed."""
    return seconds / max(1e-9, length / speed)


def _mean_worst(values: Sequence[float], unit: str, digits: int) -> str:
    if not values:
        return "nothing measured"
    return f"{sum(values) / len(values):.{digits}f} {unit} mean, {max(values):.{digits}f} {unit} worst"
