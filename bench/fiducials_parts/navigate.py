"""Goals for the program keyboard_navigate, through a pipe as a user gives them, on a robot that has no lidar."""

from __future__ import annotations

import math
import os
import select
import signal
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.fiducials_parts.driver import Driver
from bench.navigation_parts.worlds import Goal

_ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True, slots=True)
class Arrival:
    """What the program said of a goal, and how far the robot truly was from it: m and degrees."""

    said: str
    reached: bool
    error: float
    turn_error: float


class Navigation:
    """The running program. A context manager: everything that it started is gone at its end."""

    def __init__(self, environment: dict[str, str], *arguments: str) -> None:
        self._program = subprocess.Popen(
            [str(_ROOT / "ur"), "run", "keyboard_navigate", "robot_base:=magni", "use_rviz:=false", *arguments],
            env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE,
        )  # fmt: skip

    def __enter__(self) -> Navigation:
        return self

    def __exit__(self, *_: object) -> None:
        self._program.send_signal(signal.SIGINT)
        self._program.communicate()

    def drive(self, goal: Goal, driver: Driver, limit: float = 240.0) -> Arrival:
        """Send one goal, and compare where the robot ends with it."""
        assert self._program.stdin
        self._program.stdin.write(f"g {goal[0]} {goal[1]} {goal[2]}\n".encode())
        self._program.stdin.flush()
        said = self._read_line(limit)
        time.sleep(0.4)  # let the truth catch up with a robot that has stopped
        assert driver.true is not None
        here = driver.true
        turn = math.degrees(abs(math.remainder(here.yaw - math.radians(goal[2]), math.tau)))
        return Arrival(said, ": reached" in said, math.hypot(here.x - goal[0], here.y - goal[1]), turn)

    def _read_line(self, limit: float) -> str:
        assert self._program.stdout
        deadline, line = time.monotonic() + limit, b""
        while not line.endswith(b"\n"):
            if not select.select([self._program.stdout], [], [], max(0.0, deadline - time.monotonic()))[0]:
                return f"no answer within {limit:.0f} s"
            got = os.read(self._program.stdout.fileno(), 1)
            if not got:
                return "the program has ended"
            line += got
        return line.decode().strip()


def drive_goals(driver: Driver, environment: dict[str, str], goals: Sequence[Goal], *arguments: str) -> bool:
    """Drive to all goals and print the figures. Whether all were reached and nothing was touched."""
    arrivals = []
    driver.reset()
    with Navigation(environment, *arguments) as navigation:
        for number, goal in enumerate(goals):
            before, pictures, began = len(driver.offs), driver.pictures, time.monotonic()
            arrival = navigation.drive(goal, driver)
            rate = (driver.pictures - pictures) / (time.monotonic() - began)
            arrivals.append(arrival)
            strayed = max((each[0] for each in driver.offs[before:]), default=math.nan)
            print(
                f"  {number + 1:2} {arrival.said}; truly {arrival.error:.3f} m, {arrival.turn_error:.1f} degrees off;"
                f" localisation {strayed:.3f} m worst, {rate:.1f} pictures/s",
                flush=True,
            )
        lidars = driver.lidars()
    offs = [each[0] for each in driver.offs] or [math.nan]
    errors, turns = [each.error for each in arrivals], [each.turn_error for each in arrivals]
    reached = sum(each.reached for each in arrivals)
    print(
        f"navigating: reached {reached} of {len(arrivals)} with {len(lidars)} lidars; final error {_mean_worst(errors)}"
        f" m, {_mean_worst(turns, 1)} degrees; localisation {_mean_worst(offs)} m; {driver.collisions} collisions",
        flush=True,
    )
    return reached == len(goals) and driver.collisions == 0 and not lidars


def _mean_worst(values: Sequence[float], digits: int = 3) -> str:
    return f"{sum(values) / len(values):.{digits}f} mean {max(values):.{digits}f} worst"
