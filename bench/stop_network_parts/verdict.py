"""Compute from records how long a base moved after the last fresh command, and whether it moved without one.

A command is fresh from the moment a living commander publishes it. Motion at a time `t` is due to the newest command
that asked for motion along the same axis in the same direction and was published at `t` or before; its age is the time
since. No motion may be older than the lane's limit. Motion that begins, from rest, when its command is older than that
is a *ghost*: nobody has asked for it. The base has to be at rest where the records begin: of motion that had begun
before, the command is missing. Motion without any recorded command is not judged: the record is what failed.
"""

import math
from bisect import bisect_right
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from bench.stop_network_parts.lane import Lane
from bench.stop_network_parts.recorder import RESTS

from ur.robot.base import Base
from ur_nodes.motion.ramp import WheelDrive

_PERIOD = 0.005  # s
_CONTROL = 2  # periods of the controller: 100 Hz
_WHEELS = 0.025  # s: the time constant with which wheels obey their controller


@dataclass(frozen=True, slots=True)
class Ghost:
    """Motion that nobody asked for: monotonic seconds, how long, and the age of the newest command that fits it (s).

    `direction` is that of the base: ahead, back, left or right.
    """

    began: float
    seconds: float
    age: float
    direction: str


@dataclass(frozen=True, slots=True)
class Verdict:
    """The longest motion after the last fresh command (s), when that was, all ghosts, and how long the base moved.

    `way` is the longest way (m) after the last fresh command, from the moment at which it was published.

    `recorded` is False when the base moved and no command along the axis of the lane is in the record. Such a verdict
    has neither a longest motion nor ghosts, and means nothing.
    """

    longest: float
    at: float
    ghosts: tuple[Ghost, ...]
    moved: float
    recorded: bool = True
    way: float = 0.0


@dataclass(frozen=True, slots=True)
class Moving:
    """Signs of the motion at a time: -1, 0 or 1 each; `speed` ahead in m/s, where it is known."""

    at: float
    forward: int
    turn: int
    speed: float = 0.0


def simulate_base(base: Base, outputs: Iterable[tuple[float, float, float]], end: float) -> list[Moving]:
    """Motion of a base whose controller gets `outputs` (time, m/s, rad/s, in order of time), until `end`.

    The controller is that of the simulator; wheels follow it with a lag.
    """
    waiting = list(outputs)
    if not waiting:
        return []
    drive, forward, turn = WheelDrive(base, _PERIOD * _CONTROL), 0.0, 0.0
    share = 1.0 - math.exp(-_PERIOD / _WHEELS)
    found, index, start = [], 0, waiting[0][0]
    for step in range(int((end - start) / _PERIOD) + 1):
        now = start + step * _PERIOD
        while index < len(waiting) and waiting[index][0] <= now:
            drive.command(waiting[index][1], waiting[index][2], waiting[index][0])
            index += 1
        if step % _CONTROL == 0:
            drive.update(now)
        forward += share * (drive.velocity[0] - forward)
        turn += share * (drive.velocity[1] - turn)
        found.append(Moving(now, _sign(forward, RESTS[0]), _sign(turn, RESTS[1]), forward))
    return found


def judge(
    lane: Lane, commands: Sequence[tuple[float, float, float]], motion: Iterable[Moving], since: float
) -> Verdict:
    """Judge the motion of a lane from `since` on by the commands (time, m/s, rad/s) that were published."""
    asked: dict[int, list[float]] = {-1: [], 1: []}
    for at, forward, turn in sorted(commands):
        along, _ = lane.pick(forward, turn)
        if along:
            asked[1 if along > 0 else -1].append(at)
    longest, longest_at, moved, moved_at_all = 0.0, 0.0, 0.0, False
    ghosts: list[Ghost] = []
    began: tuple[int, float, float] | None = None  # sign, when, age then
    way = longest_way = older = 0.0
    last = -math.inf
    for moving in motion:
        along, across = lane.pick(moving.forward, moving.turn)
        sign = int(along or 2 * across)  # across the lane nobody ever asks for motion
        if began and began[0] != sign:
            _end_motion(lane, began, last, since, ghosts)
            began = None
        last = moving.at
        if not sign:
            continue
        moved_at_all = True
        age = _age(asked.get(sign, []), moving.at)
        way = (way if age > older else 0.0) + abs(moving.speed) * _PERIOD
        older = age
        began = began or (sign, moving.at, age)
        if moving.at < since:
            continue
        moved += _PERIOD
        if began[2] <= lane.limit and age > longest:
            longest, longest_at = age, moving.at
        if began[2] <= lane.limit:
            longest_way = max(longest_way, way)
    if began:
        _end_motion(lane, began, last, since, ghosts)
    if moved_at_all and not any(asked.values()):
        return Verdict(0.0, 0.0, (), moved, recorded=False)
    return Verdict(longest, longest_at, tuple(ghosts), moved, way=longest_way)


def is_at_rest(outputs: Iterable[tuple[float, float, float]], since: float) -> bool:
    """Return whether no velocity but zero arrived at the motors from `since` on."""
    return not any(forward or turn for at, forward, turn in outputs if at >= since)


def _end_motion(lane: Lane, began: tuple[int, float, float], last: float, since: float, ghosts: list[Ghost]) -> None:
    sign, at, age = began
    if age > lane.limit and last >= since:
        forward = (lane.axis == "linear") is (abs(sign) == 1)  # 2: across the lane
        directions = ("ahead", "back") if forward else ("left", "right")
        ghosts.append(Ghost(at, last - at + _PERIOD, age, directions[sign < 0]))


def _age(asked: Sequence[float], now: float) -> float:
    index = bisect_right(asked, now)
    return now - asked[index - 1] if index else math.inf


def _sign(value: float, rest: float) -> int:
    return 0 if abs(value) < rest else int(math.copysign(1, value))
