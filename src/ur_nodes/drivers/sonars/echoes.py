"""HC-SR04 sonars on pins: a pulse triggers one, and its echo pin is high as long as the sound travels. Pure.

Source: the data sheet "Ultrasonic Ranging Module HC-SR04": a trigger of 10 us, 8 cycles of 40 kHz, and an echo pulse.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Protocol

from ur.robot.base import Sonars
from ur_nodes.ports.values import Range


def make_range(sonars: Sonars, frame: str, distance: float, stamp: int) -> Range:
    """A distance (m) as REP 117 has it: +inf for nothing within `range_max`, -inf for nearer than `range_min`."""
    if distance > sonars.range_max:
        distance = math.inf
    elif distance < sonars.range_min:
        distance = -math.inf
    return Range(stamp, frame, distance, sonars.field_of_view, sonars.range_min, sonars.range_max)


LONGEST = 0.045  # s that an echo may take: an HC-SR04 without one gives up after 38 ms


@dataclass(frozen=True, slots=True)
class Listened:
    """The edges since a sonar was triggered, and when that was and listening ended (ns, the kernel's monotonic clock).

    `busy`: its echo pin was high before, and it was not triggered.
    """

    edges: tuple[PinEdge, ...]
    triggered: int
    ended: int
    busy: bool = False


class SonarPort(Protocol):
    """The pins of sonars."""

    def ping(self, sonar: SonarPins) -> Listened | str:
        """Trigger a sonar and listen until its echo has ended, at most for LONGEST; why that failed. On a worker."""

    def close(self) -> None:
        """Give the pins back."""


SPEED_OF_SOUND = 343.0  # m/s, at 20 degrees Celsius, as pi_sonar has it
SHORTEST = 60_000  # ns: a pulse of 1 cm; shorter ones are noise


@dataclass(frozen=True, slots=True)
class SonarPins:
    """The pins of a sonar, by their offsets in the GPIO chip."""

    trigger: int
    echo: int


@dataclass(frozen=True, slots=True)
class PinEdge:
    """A change of a pin: to high (`rising`) or low, at a time (ns) of the kernel's monotonic clock."""

    pin: int
    rising: bool
    time: int


@dataclass(frozen=True, slots=True)
class Echo:
    """A distance (m), and when the sound was there (ns): in the middle of the pulse."""

    distance: float
    time: int


def find_echo(edges: Iterable[PinEdge], pin: int, triggered: int) -> Echo | None:
    """Find the first whole pulse of a pin after it was triggered (ns); None without one.

    Edges of other pins, pulses from before and noise are left out.
    """
    risen: int | None = None
    for edge in edges:
        if edge.pin != pin or edge.time < triggered:
            continue
        if edge.rising:
            risen = edge.time
        elif risen is not None:
            if edge.time - risen >= SHORTEST:
                return Echo((edge.time - risen) / 1e9 * SPEED_OF_SOUND / 2.0, (edge.time + risen) // 2)
            risen = None
    return None


def magni_pins() -> tuple[SonarPins, ...]:
    """Return the sonars of a Magni, `sonar_0` to `sonar_4` of pi_sonar.cpp: pins of the BCM chip."""
    pins = ((20, 21), (12, 16), (23, 24), (27, 22), (19, 26))
    return tuple(SonarPins(trigger, echo) for trigger, echo in pins)
