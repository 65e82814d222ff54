"""A board of HC-SR04 sonars at the level of their pins: when edges are seen, and the faults that such boards have.

From the data sheet: the echo pin rises after the burst, and falls when the sound is back, or after 38 ms without one.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from ur_nodes.drivers.sonars.echoes import Listened, PinEdge, SonarPins
from ur_nodes.memory.bus import Bus

BURST = 450_000  # ns from the trigger to the rising edge
LOST = 38_000_000  # ns of a pulse without an echo


@dataclass
class EchoBoard:
    """See SonarPort. `measure` gives the distance (m) at an echo pin now. The clock of the edges is that of the bus."""

    bus: Bus
    measure: Callable[[int], float]
    plugged: bool = True
    """The chip is there."""
    silent: frozenset[int] = frozenset()
    """Echo pins whose sonars are not there."""
    stuck: frozenset[int] = frozenset()
    """Echo pins that are high."""
    noise: float = 0.0
    """The share of pings with a spike on every pin."""
    cut: float = 0.0
    """The share of pings of which an edge is lost."""
    random: random.Random = field(default_factory=lambda: random.Random(1))
    closed: int = 0
    pinged: list[int] = field(default_factory=list)

    def open(self) -> EchoBoard | str:
        return self if self.plugged else "no such file or directory"

    def ping(self, sonar: SonarPins) -> Listened | str:
        if not self.plugged:
            return "no such device"
        now = self.bus.now
        self.pinged.append(sonar.trigger)
        if sonar.echo in self.stuck:
            return Listened((), now, now + 45_000_000, busy=True)
        edges: list[PinEdge] = []
        if sonar.echo not in self.silent:
            distance = self.measure(sonar.echo)
            pulse = LOST if distance > 6.5 else round(2.0 * max(distance, 0.02) / 343.0 * 1e9)
            edges = [PinEdge(sonar.echo, True, now + BURST), PinEdge(sonar.echo, False, now + BURST + pulse)]
        if edges and self.random.random() < self.cut:
            edges.pop(self.random.randrange(2))
        if self.random.random() < self.noise:
            at = now + self.random.randrange(1_000_000)
            spikes = [PinEdge(sonar.echo, up, at + (not up) * 20_000) for up in (True, False)]
            edges = sorted([*edges, *spikes], key=lambda each: each.time)
        ended = edges[-1].time if edges else now + 45_000_000
        return Listened(tuple(edges), now, ended)

    def close(self) -> None:
        self.closed += 1


def distances(at: Mapping[int, float]) -> Callable[[int], float]:
    """Distances that stay, by echo pin."""
    return at.__getitem__
