"""Values of no frame: signals, numbers, lines of the log, moments, and answers."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Level = Literal["debug", "info", "warn", "error"]
"""The level of a line of the log."""


NO_MATRIX: NDArray[np.float64] = np.zeros((0, 0))
"""Stands for a covariance that is not given."""


@dataclass(frozen=True, slots=True)
class Signal:
    """An event without data."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number in double precision; a `float` is sent in single precision."""

    value: float


@dataclass(frozen=True, slots=True)
class LogLine:
    """A line that a node has logged; `node` is its full name."""

    node: str
    level: Level
    text: str


@dataclass(frozen=True, slots=True)
class Time:
    """A moment, ns."""

    stamp: int


@dataclass(frozen=True, slots=True)
class ClockTime:
    """The time of all nodes in ns, as a clock publishes it."""

    stamp: int


@dataclass(frozen=True, slots=True)
class Result:
    """A service's answer: success, a text for the user, and the requested `value`."""

    success: bool
    text: str = ""
    value: object = None
