"""The shape of what triggers sonars and listens to their echoes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from ur_nodes.drivers.sonars.echoes import PinEdge, SonarPins

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
