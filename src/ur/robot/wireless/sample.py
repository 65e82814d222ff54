"""Samples of a link, one a second, and the parser of ping(8). Pure."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import median

from ur.robot.doctor.wifi import WirelessLink

SETTLED = 5  # number of later echoes after which a missing one counts as lost: a second, at five per second
_REPLY = re.compile(r"icmp_seq=(\d+).* time=([\d.]+) ms")
_MISSING = re.compile(r"no answer yet for icmp_seq=(\d+)|icmp_seq=(\d+) .*[Uu]nreachable")


@dataclass(frozen=True, slots=True)
class Sample:
    """One second: `time` (s since 1970), echoes `sent` and `lost`, and the median `latency` (s) of the others.

    `here` and `there` are the wireless links of this computer and the robot; None without one, or without an answer.
    """

    time: float
    sent: int = 0
    lost: int = 0
    latency: float | None = None
    here: WirelessLink | None = None
    there: WirelessLink | None = None

    @property
    def gap(self) -> bool:
        """Return whether no echo was answered in this second."""
        return self.latency is None

    @property
    def loss(self) -> float:
        """The fraction (0..1) of echoes that were lost."""
        return self.lost / self.sent if self.sent else 1.0


@dataclass(slots=True)
class Echoes:
    """Parser of the lines of `ping -O`. Lines without an echo are ignored."""

    _found: dict[int, float | None] = field(default_factory=dict)
    _taken: int = 0

    def read(self, line: str) -> None:
        """Parse a line. An echo that arrives after it was reported missing still counts, unless a second has passed."""
        reply = _REPLY.search(line)
        if reply:
            self._found[int(reply[1])] = float(reply[2]) / 1000
            return
        missing = _MISSING.search(line)
        if missing:
            self._found.setdefault(int(missing[1] or missing[2]), None)

    def pop(self) -> tuple[int, int, float | None]:
        """Return (sent, lost, median latency in s) since the last call."""
        end = max(self._found, default=0) - SETTLED
        taken = [self._found.pop(number, None) for number in range(self._taken + 1, end + 1)]
        self._taken = max(self._taken, end)
        for number in [number for number in self._found if number <= self._taken]:
            del self._found[number]
        back = [latency for latency in taken if latency is not None]
        return len(taken), len(taken) - len(back), median(back) if back else None


@dataclass(frozen=True, slots=True)
class Summary:
    """Statistics of several seconds: latencies in s, `loss` 0..1, signals in dBm as (worst, median); None: unknown."""

    seconds: int
    loss: float
    latency: tuple[float, float, float] | None
    here: tuple[float, float] | None
    there: tuple[float, float] | None
    gaps: int


def summarize(samples: Sequence[Sample]) -> Summary:
    """Return least, median and greatest latency; loss of all echoes; worst and median signal; number of outages."""
    latencies = sorted(sample.latency for sample in samples if sample.latency is not None)
    sent, lost = sum(sample.sent for sample in samples), sum(sample.lost for sample in samples)
    return Summary(
        len(samples),
        lost / sent if sent else 1.0,
        (latencies[0], median(latencies), latencies[-1]) if latencies else None,
        _signals(sample.here for sample in samples),
        _signals(sample.there for sample in samples),
        sum(sample.gap and not before.gap for before, sample in pairwise(samples)),
    )


def _signals(links: Iterable[WirelessLink | None]) -> tuple[float, float] | None:
    signals = [link.signal for link in links if link and link.signal is not None]
    return (min(signals), median(signals)) if signals else None
