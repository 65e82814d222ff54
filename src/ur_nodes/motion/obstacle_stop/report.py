"""The state of the obstacle stop: as a line for screens, and as JSON on a topic."""

import math
from dataclasses import dataclass
from typing import Literal, TypeAlias

from ur.source.foreign.json_values import BadJsonError, ForeignValue, read_json, write_json
from ur.source.printable import printable
from ur_nodes.motion.obstacle_stop.guard import BLIND, Cause, GuardVerdict

State = Literal["none", "off", "clear", "slowed", "stopped"]
Motion: TypeAlias = tuple[float, float, float]
"""Ahead (m/s), turning (rad/s), to the left (m/s)."""

_MOST = 2000  # characters
_LONGEST = 120
_STEP = 0.05  # m
_NOTICED = 0.9  # of the wanted velocity: what is not slower than that is not reported
_TOO_LONG = 3600.0  # s


@dataclass(frozen=True, slots=True)
class ObstacleReport:
    """The state, and its description in a line: "stopped: obstacle 0.05 m ahead"; empty while nothing is in the way.

    `none`: the base has no sensor that the obstacle stop can use.
    """

    state: State = "none"
    text: str = ""


class _WireReport(ForeignValue, frozen=True, forbid_unknown_fields=False):
    state: State
    text: object = ""


OFF = ObstacleReport("off", "the obstacle stop is off")
CLEAR = ObstacleReport("clear")


def report_of(verdict: GuardVerdict | None, wanted: Motion, output: Motion) -> ObstacleReport:
    """The report of a verdict on a wanted velocity, and what was sent instead."""
    if verdict is None or verdict.cause is None:
        return CLEAR
    if all(abs(sent) >= _NOTICED * abs(asked) for sent, asked in zip(output, wanted, strict=True)):
        return CLEAR
    if verdict.forward == 0.0 and verdict.turn == 0.0 and verdict.left == 0.0:
        return ObstacleReport("stopped", f"stopped: {_describe(verdict.cause)}")
    slow = f" to {BLIND:g} m/s" if verdict.cause.kind in ("unseen", "silent") else ""
    return ObstacleReport("slowed", f"slowed{slow}: {_describe(verdict.cause)}")


def _describe(cause: Cause) -> str:
    if cause.kind == "bumper":
        return f"{cause.name} pressed" if "bumper" in cause.name else f"bumper {cause.name} pressed"
    if cause.kind == "cliff":
        return f"cliff sensor {cause.name} sees no floor"
    if cause.kind == "unseen":
        return f"no sensor sees what is {cause.side}"
    if cause.kind == "silent":
        return f"no {cause.name} for {cause.age:.1f} s" if cause.age < _TOO_LONG else f"no {cause.name} yet"
    if cause.distance < _STEP:
        return f"obstacle close {cause.side}"
    return f"obstacle {_STEP * math.floor(cause.distance / _STEP + 1e-6):.2f} m {cause.side}"


def write_report(report: ObstacleReport) -> str:
    """The report as JSON."""
    return write_json(report)


def read_report(text: str) -> ObstacleReport | None:
    """Parse the JSON report of a mux; None if it is invalid."""
    try:
        found = read_json(text, _WireReport, _MOST)
    except BadJsonError:
        return None
    line = found.text
    return ObstacleReport(found.state, printable(line)[:_LONGEST] if isinstance(line, str) else "")
