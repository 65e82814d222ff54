"""Trials with one robot: it drives at full speed, somebody is lost, and it is looked at until it stands."""

import contextlib
import itertools
import json
import random
import signal
import time
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import TextIO

from bench.stop_parts.nursery import Child
from bench.stop_parts.people import Joystick, Keyboard, Navigation
from bench.stop_parts.robot import Robot

CAUSES = ("viewer", "network", "teleop", "navigation", "mux")
_DIRECTIONS = ((1, 0), (-1, 0), (0, 1), (1, 1), (-1, 1))
_OPEN = (2.0, 0.3)  # m: a place with room on all sides
_GOAL = (8.0, 0.3)  # m: straight ahead, with nothing between
_FULL = 0.9  # of the speed that is commanded: the mux lets a command's age cost some of it
_REST = 0.25  # s that it has to have stood
_LONGEST = 5.0  # s: a robot that still moves then will not stop
_PATIENCE = 30.0  # s: for a robot to drive at full speed
_ATTEMPTS = 5  # of a trial, on a computer that is busy
BUSY = 0.06  # s that mux and base together may wait for a processor, of the half second that a trial's end takes


@dataclass(frozen=True, slots=True)
class Trial:
    """One trial: the stop time, and how long mux and base waited for a processor meanwhile, in s.

    One that is `disturbed` does not count: the computer was too busy with other things.
    """

    base: str
    cause: str
    seconds: float
    waited: float
    disturbed: bool


def run_trials(robot: Robot, causes: Iterable[str], trials: int, seed: int, answers: TextIO) -> None:
    """Run them, causes by turns, and write each as a line of JSON."""
    crew = _Crew(robot, random.Random(seed))
    for trial in range(trials):
        for cause in causes:
            for attempt in range(_ATTEMPTS):
                try:
                    seconds, waited = crew.lose(cause, trial)
                except NotFastError as problem:
                    if attempt + 1 == _ATTEMPTS:
                        raise SystemExit(f"bench/stop: {problem}; see {robot.folder / 'nodes.log'}") from None
                    continue
                told = Trial(robot.name, cause, round(seconds, 4), round(waited, 4), waited > BUSY)
                answers.write(json.dumps(asdict(told)) + "\n")
                answers.flush()
                if not told.disturbed:
                    break


class NotFastError(Exception):
    """The robot did not come to drive at full speed: the mux slows it down when commands come late."""


class _Crew:
    """Those who drive a robot, and its mux."""

    def __init__(self, robot: Robot, chance: random.Random) -> None:
        self._robot = robot
        self._chance = chance
        self._numbers = itertools.count()
        self._navigation: Navigation | None = None

    def lose(self, cause: str, trial: int) -> tuple[float, float]:
        """One trial: the stop time, and how long mux and base waited for a processor."""
        robot, limits = self._robot, self._robot.base.limits
        if cause == "navigation":
            return self._lose_navigation(trial)
        person: Keyboard | Joystick
        if trial % 2:
            person = Keyboard(robot.nursery, limits.velocity, limits.angular_velocity)
        else:
            person = Joystick(robot.nursery, robot.folder / f"js{next(self._numbers)}")
        with contextlib.closing(person):
            result = self._lose_person(cause, person, _DIRECTIONS[trial // 2 % len(_DIRECTIONS)])
        if cause == "mux":
            robot.start_mux()
        return result

    def _lose_person(self, cause: str, person: Keyboard | Joystick, direction: tuple[int, int]) -> tuple[float, float]:
        robot, limits = self._robot, self._robot.base.limits
        robot.watch.place(*_OPEN, 0.0)
        person.drive(*direction)
        _wait_for_speed(robot, direction[0] * limits.velocity, direction[1] * limits.angular_velocity)
        time.sleep(self._chance.uniform(0.15, 0.35))
        if cause == "mux":
            return self._watch_the_end(robot.mux, (robot.mux,), signal.SIGKILL)
        children = (person.teleop,) if cause == "teleop" else person.viewer
        return self._watch_the_end(person.teleop, children, signal.SIGSTOP if cause == "network" else signal.SIGKILL)

    def _lose_navigation(self, trial: int) -> tuple[float, float]:
        robot = self._robot
        navigation = self._navigation or Navigation(robot.nursery)
        self._navigation = None
        robot.watch.place(_OPEN[0], _OPEN[1], (0.0, 0.5, -0.5)[trial % 3])
        if not self._goes_fast(navigation):  # it may have given up
            navigation.close()
            raise NotFastError(f"navigation does not drive {robot.name} at full speed")
        time.sleep(self._chance.uniform(0.0, 0.4))
        result = self._watch_the_end(navigation.teleop, (navigation.teleop,), signal.SIGKILL)
        self._navigation = Navigation(robot.nursery)  # it starts while others are tried
        return result

    def _goes_fast(self, navigation: Navigation) -> bool:
        """Whether it drove at full speed within a time."""
        velocity, asked, end = self._robot.base.limits.velocity, 0.0, time.monotonic() + _PATIENCE
        while time.monotonic() < end:
            speed = abs(self._robot.watch.now[1])
            if speed >= _FULL * velocity:
                return True
            if speed < 0.02 and time.monotonic() - asked > 2.0:  # it may not have had map and frames the first time
                navigation.drive(*_GOAL)
                asked = time.monotonic()
            time.sleep(0.005)
        return False

    def _watch_the_end(self, lost: Child, children: Iterable[Child], number: int) -> tuple[float, float]:
        """Take away, and wait until the robot stands."""
        lives = lost is not self._robot.mux
        before = self._robot.waited(mux=lives)
        for child in children:
            child.signal(number)
        stands = _wait_until_it_stands(self._robot, time.time())
        return stands - lost.last_sent(), self._robot.waited(mux=lives) - before


def _wait_for_speed(robot: Robot, ahead: float, turn: float) -> None:
    end = time.monotonic() + _PATIENCE
    while time.monotonic() < end:
        _, speed, spin = robot.watch.now
        if abs(speed) >= _FULL * abs(ahead) - 1e-9 and abs(spin) >= _FULL * abs(turn) - 1e-9:
            return
        time.sleep(0.002)
    raise NotFastError(f"{robot.name} does not drive at {ahead:g} m/s and {turn:g} rad/s")


def _wait_until_it_stands(robot: Robot, lost_at: float) -> float:
    """When it came to stand for good; the latest moment looked at, where it never does."""
    while (now := robot.watch.now[0]) < lost_at + _LONGEST:
        since = robot.watch.stands_since()
        if since < now - _REST and now > lost_at + _REST:
            return since
        time.sleep(0.02)
    return now
