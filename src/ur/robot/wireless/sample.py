"""Samples of a link, one a second: the parser of ping(8), advice from the last ones, and a file of them."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timezone
from itertools import pairwise
from statistics import median
from typing import TextIO

from ur.robot.doctor.rules.network import LATENCY_SECONDS, SLOW_RATE, WEAK_SIGNAL
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


_LINK = ("device", "signal_dbm", "rate_mbit_s", "frequency_mhz")
COLUMNS = (
    *("time", "seconds", "sent", "lost", "latency_ms"),
    *(f"here_{name}" for name in _LINK),
    *(f"robot_{name}" for name in _LINK),
)
HEADER = ",".join(COLUMNS) + "\n"


def render_row(sample: Sample, start: float) -> str:
    """Format a second as a line. `start` (s since 1970) is its beginning; unknown values are left empty."""
    moment = datetime.fromtimestamp(sample.time, timezone.utc).isoformat(timespec="milliseconds")
    latency = "" if sample.latency is None else f"{sample.latency * 1000:.3f}"
    first = (moment, f"{sample.time - start:.1f}", str(sample.sent), str(sample.lost), latency)
    return ",".join((*first, *_link(sample.here), *_link(sample.there))) + "\n"


def write_row(file: TextIO, sample: Sample, start: float) -> None:
    """Write a second and flush it, so that a crash cannot lose it."""
    file.write(render_row(sample, start))
    file.flush()


def _link(link: WirelessLink | None) -> tuple[str, ...]:
    if link is None:
        return "", "", "", ""
    return link.device, *("" if value is None else f"{value:g}" for value in (link.signal, link.rate, link.frequency))


RECENT = 10  # s
LOSS = 0.01  # noticeable when driving


def advise(samples: Sequence[Sample], names: tuple[str, str]) -> str:
    """Return one sentence of advice. `names` are the names of this computer and of the robot."""
    recent = samples[-RECENT:]
    if not recent or not any(sample.sent for sample in samples):
        return "measuring ..."
    if recent[-1].gap:
        return _explain_gap(samples, names[1])
    links = [(name, link) for name, link in zip(names, (recent[-1].here, recent[-1].there), strict=True) if link]
    for name, link in links:
        if link.signal is not None and link.signal < WEAK_SIGNAL:
            weak = f"the signal at {name} is weak ({link.signal:.0f} dBm)"
            return f"{weak}: nearer to the access point, or an antenna in the open"
    whole = summarize(recent)
    middle = whole.latency[1] if whole.latency else 0.0
    slow = middle > LATENCY_SECONDS
    saving = [name for name, link in links if link.power_save]
    if slow and saving:
        return f"{middle * 1000:.0f} ms, and {saving[0]} saves power: ur doctor {names[1]} --fix"
    if whole.loss > LOSS:
        return f"{whole.loss:.0%} are lost: {_crowded(links)}"
    if slow:
        return f"packets wait: {_crowded(links)}"
    for name, link in links:
        if link.rate is not None and link.rate < SLOW_RATE:
            return f"{name} sends with {link.rate:g} Mbit/s only: {_crowded(links)}"
    return "good: compressed pictures and driving work here"


def _explain_gap(samples: Sequence[Sample], name: str) -> str:
    away = 0
    for sample in reversed(samples):
        if not sample.gap:
            break
        away += 1
    if away == len(samples):
        return f"{name} does not answer"
    return f"{name} has not answered for {away} s: go back to where it did, and put an access point between"


def _crowded(links: Sequence[tuple[str, WirelessLink]]) -> str:
    if any(link.band == "2.4 GHz" for _, link in links):
        return "the 2.4 GHz band is crowded: 5 GHz, with a dual band (802.11ac) adapter"
    return "another channel, or fewer computers on it" if links else "what else uses the network?"
