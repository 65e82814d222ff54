"""Trials with one robot: it drives at full speed, somebody is lost, and it is looked at until it stands."""

from __future__ import annotations

import contextlib
import itertools
import json
import random
import signal
import time
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from typing import TextIO

from bench.stop_parts.people import Joystick, Keyboard, Navigation, wait_for
from bench.stop_parts.robot import Robot

CAUSES = ("viewer", "network", "teleop", "navigation", "mux")
_DIRECTIONS = ((1, 0), (-1, 0), (0, 1), (1, 1), (-1, 1))
_OPEN = (2.0, 0.3)  # m: a place with room on all sides
_GOAL = (8.0, 0.3)  # m: straight ahead, with nothing between
_FULL = 0.9  # of the speed that is commanded: the mux lets a command's age cost some of it
_REST = 0.25  # s that it has to have stood
_LONGEST = 5.0  # s: a robot that still moves then will not stop


@dataclass(frozen=True, slots=True)
class Trial:
    """One trial: the stop time in s, and the worst delay of a clock in this process meanwhile."""

    base: str
    cause: str
    seconds: float
    late: float


def run_trials(robot: Robot, causes: Iterable[str], trials: int, seed: int, answers: TextIO) -> None:
    """Run them, causes by turns, and write each as a line of JSON."""
    chance, numbers = random.Random(seed), itertools.count()
    limits = robot.base.limits
    navigation: Navigation | None = None
    for trial in range(trials):
        for cause in causes:
            if cause == "navigation":
                navigation = navigation or Navigation(robot.nursery)
                seconds, late = _lose_navigation(robot, navigation, trial, chance)
                navigation = Navigation(robot.nursery)  # it starts while others are tried
            else:
                person: Keyboard | Joystick
                if trial % 2:
                    person = Keyboard(robot.nursery, limits.velocity, limits.angular_velocity)
                else:
                    person = Joystick(robot.nursery, robot.folder / f"js{next(numbers)}")
                with contextlib.closing(person):
                    direction = _DIRECTIONS[trial // 2 % len(_DIRECTIONS)]
                    seconds, late = _lose_person(robot, cause, person, direction, chance)
                if cause == "mux":
                    robot.start_mux()
            answers.write(json.dumps(asdict(Trial(robot.name, cause, round(seconds, 4), round(late, 4)))) + "\n")
            answers.flush()


def _lose_person(
    robot: Robot, cause: str, person: Keyboard | Joystick, direction: tuple[int, int], chance: random.Random
) -> tuple[float, float]:
    robot.watch.place(*_OPEN, 0.0)
    person.drive(*direction)
    limits = robot.base.limits
    _wait_for_speed(robot, direction[0] * limits.velocity, direction[1] * limits.angular_velocity)
    with _lateness() as late:
        time.sleep(chance.uniform(0.15, 0.35))
        if cause == "mux":
            robot.mux.signal(signal.SIGKILL)
            lost = robot.mux
        else:
            for child in person.viewer if cause != "teleop" else (person.teleop,):
                child.signal(signal.SIGSTOP if cause == "network" else signal.SIGKILL)
            lost = person.teleop
        stands = _wait_until_it_stands(robot, time.time())
    return stands - lost.last_sent(), late[0]


def _lose_navigation(robot: Robot, navigation: Navigation, trial: int, chance: random.Random) -> tuple[float, float]:
    robot.watch.place(_OPEN[0], _OPEN[1], (0.0, 0.5, -0.5)[trial % 3])
    velocity, asked = robot.base.limits.velocity, 0.0

    def fast() -> bool:
        nonlocal asked
        speed = abs(robot.watch.now[1])
        if speed < 0.02 and time.monotonic() - asked > 2.0:  # it may not have had map and frames the first time
            navigation.drive(*_GOAL)
            asked = time.monotonic()
        return speed >= _FULL * velocity

    wait_for(fast, f"navigation of {robot.name} to drive at full speed; it wrote {robot.folder / 'nodes.log'}")
    with _lateness() as late:
        time.sleep(chance.uniform(0.0, 0.4))
        navigation.close()
        stands = _wait_until_it_stands(robot, time.time())
    return stands - navigation.teleop.last_sent(), late[0]


def _wait_for_speed(robot: Robot, ahead: float, turn: float) -> None:
    def full() -> bool:
        _, speed, spin = robot.watch.now
        return abs(speed) >= _FULL * abs(ahead) - 1e-9 and abs(spin) >= _FULL * abs(turn) - 1e-9

    what = f"{robot.name} to drive at {ahead:g} m/s and {turn:g} rad/s; its nodes wrote {robot.folder / 'nodes.log'}"
    wait_for(full, what)


def _wait_until_it_stands(robot: Robot, lost_at: float) -> float:
    """When it came to stand for good; the latest moment looked at, where it never does."""
    while (now := robot.watch.now[0]) < lost_at + _LONGEST:
        since = robot.watch.stands_since()
        if since < now - _REST and now > lost_at + _REST:
            return since
        time.sleep(0.02)
    return now


@contextlib.contextmanager
def _lateness() -> Iterator[list[float]]:
    """How late a clock of 100 Hz in this process is at worst, s: what the computer's other load costs."""
    import threading

    worst, ended = [0.0], threading.Event()

    def look() -> None:
        due = time.monotonic()
        while not ended.is_set():
            due += 0.01
            time.sleep(max(0.0, due - time.monotonic()))
            worst[0] = max(worst[0], time.monotonic() - due)
            due = max(due, time.monotonic() - 0.01)

    thread = threading.Thread(target=look, daemon=True)
    thread.start()
    try:
        yield worst
    finally:
        ended.set()
        thread.join()
