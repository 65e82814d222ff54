"""Tries of one base: drives into things at full speed, and drives along a corridor with and without the guard."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from bench.obstacles_parts.drive import Drive
from bench.obstacles_parts.scenes import CORRIDOR, SCENES, STEPPER, make_corridor, make_scene

from ur.robot.base import Base, load_base
from ur.source.diagnostic import UserError
from ur_nodes.geometry.pose import Pose2
from ur_nodes.motion.mux_events import Velocity
from ur_nodes.motion.mux_settings import slow_to_sight

PACKAGE = Path(__file__).resolve().parents[2] / "ubiquity_launches"
_SECONDS = 15.0  # of a try
_STEPS_IN = 0.5  # m before the outline
_LAPS = 5  # drives along the corridor


@dataclass
class Result:
    """The result of a base: contacts by scene, seen coming and not; ratios of time and way in the corridor; costs."""

    name: str
    tries: int = 0
    seen: dict[str, list[str]] = field(default_factory=dict)
    unseen: dict[str, list[str]] = field(default_factory=dict)
    time_ratio: float = math.nan
    way_ratio: float = math.nan
    corridor: list[str] = field(default_factory=list)
    decision: float = 0.0  # s
    load: float = 0.0  # share of a core for readings


def try_base(name: str, tries: int, seed: int, *, guarded: bool = True, speed: float = 0.0) -> Result:
    """Make so many tries with a base, `magni` or `magni/lidar`, and drive along the corridor; at `speed`, if given."""
    base_name, _, variant = name.partition("/")
    base = load_base(PACKAGE, base_name, variant)
    base, _ = slow_to_sight(replace(base, limits=replace(base.limits, velocity=speed or base.limits.velocity)))
    result = Result(name)
    seconds, decisions, readings = 0.0, 0, 0.0
    for number in range(tries):
        kind = SCENES[number % len(SCENES)]
        drive = run_try(base, kind, seed + number, guarded=guarded)
        where = f"try {seed + number}"
        result.seen.setdefault(kind, []).extend(f"{where}: {each}" for each in drive.contacts)
        result.unseen.setdefault(kind, []).extend(f"{where}: {each}" for each in drive.unseen)
        result.tries += 1
        seconds, decisions = seconds + drive.seconds, decisions + drive.decisions
        readings += drive.readings / _SECONDS
    result.decision = seconds / max(1, decisions)
    result.load = readings / max(1, tries)
    _measure_corridor(base, seed, result)
    return result


def run_try(base: Base, kind: str, seed: int, *, guarded: bool = True) -> Drive:
    """Drive towards something at full speed, then anywhere, as somebody does who plays with the keys."""
    random = np.random.default_rng(seed)
    world = make_scene(kind, random, 2.0 * _extra_way(base))
    keys = _Keys(base, random)
    drive = Drive(base, world, keys.command, guarded=guarded, seed=seed)
    if kind == "stepping in":
        keys.on_step = lambda: _step_in(drive, random)
    drive.run(_SECONDS)
    return drive


class _Keys:
    """Commands at full speed: ahead or back for some seconds, then another combination every now and then."""

    def __init__(self, base: Base, random: np.random.Generator) -> None:
        self._limits, self._random = base.limits, random
        self._way = 1.0 if random.random() < 0.7 else -1.0
        self._now = Velocity(self._way * base.limits.velocity, 0.0)
        self._until = random.uniform(3.0, 6.0)
        self._steps_at = random.uniform(0.8, 2.5)
        self.on_step: Callable[[], None] = lambda: None

    def command(self, now: float, _pose: Pose2) -> Velocity:
        """Return the command at a time (s)."""
        if now >= self._steps_at:
            self._steps_at = math.inf
            self.on_step()
        if now >= self._until:
            self._until = now + self._random.uniform(0.3, 2.0)
            forward, turn = self._random.choice((-1.0, 0.0, 1.0, 1.0)), self._random.choice((-1.0, 0.0, 0.0, 1.0))
            self._now = Velocity(forward * self._limits.velocity, turn * self._limits.angular_velocity)
        return self._now


def _extra_way(base: Base) -> float:
    """Return the way (m) that a fast base needs to come to rest."""
    return base.limits.way_to_rest if base.limits.fast else 0.0


def _step_in(drive: Drive, random: np.random.Generator) -> None:
    """Put somebody into the way, half a metre before the outline on the side that the robot drives to."""
    pose = drive.simulation.pose(0)
    xs = [x for x, _ in drive.base.footprint]
    ahead = drive.simulation.velocity(0)[0] >= 0.0
    away = _STEPS_IN + _extra_way(drive.base)
    x = max(xs) + away + 0.125 if ahead else min(xs) - away - 0.125
    place = pose.compose(Pose2(x, random.uniform(-0.1, 0.1), 0.0))
    try:
        drive.simulation.set_pose(STEPPER, place)
    except UserError:  # a wall is there
        return


def _measure_corridor(base: Base, seed: int, result: Result) -> None:
    times: list[list[float]] = [[], []]
    ways: list[list[float]] = [[], []]
    for number in range(_LAPS):
        for guarded in (False, True):
            random = np.random.default_rng(seed + number)
            world = make_corridor(random)
            drive = Drive(base, world, _Steering(base, random).command, guarded=guarded, seed=seed + number)
            times[guarded].append(drive.run(120.0, lambda pose: pose.x > CORRIDOR[0] - 1.2))
            ways[guarded].append(drive.way)
            result.corridor += drive.contacts + drive.unseen if guarded else []
    result.time_ratio = sum(times[True]) / sum(times[False])
    result.way_ratio = sum(ways[True]) / sum(ways[False])


class _Steering:
    """A driver who keeps to the middle of a corridor as people do: late, and not exactly."""

    def __init__(self, base: Base, random: np.random.Generator) -> None:
        self._limits, self._random = base.limits, random
        self._due, self._turn = 0.0, 0.0

    def command(self, now: float, pose: Pose2) -> Velocity:
        """Return the command at a time (s)."""
        if now >= self._due:
            self._due = now + 0.25
            aim = math.atan2(self._random.normal(0.0, 0.1) - pose.y, 0.8)
            error = aim - pose.yaw + self._random.normal(0.0, 0.05)
            self._turn = max(-1.0, min(1.0, 2.0 * error)) * self._limits.angular_velocity
        return Velocity(self._limits.velocity, self._turn)
