"""Durations of the steps of a start, and the critical path to the last ready node."""

from __future__ import annotations

import os
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ur.source.run_users import read_birth


def read_clock() -> float:
    """Return seconds since boot: the clock of process start times."""
    return time.clock_gettime(time.CLOCK_BOOTTIME)


@dataclass(slots=True)
class Timings:
    """End times of the steps of a start, in order, and the times at which nodes started and became ready."""

    born: float
    steps: list[tuple[str, float]] = field(default_factory=list)
    started: dict[str, float] = field(default_factory=dict)
    up: dict[str, float] = field(default_factory=dict)

    def mark(self, step: str) -> None:
        """Record that a step has just ended."""
        self.steps.append((step, read_clock()))


def begin_timings() -> Timings:
    """Start timings from the start of this process, which is known to one clock tick."""
    return Timings((read_birth(os.getpid()) or 0) / os.sysconf("SC_CLK_TCK"))


def describe_timings(
    born: float, steps: Sequence[tuple[str, float]], started: Mapping[str, float], up: Mapping[str, float]
) -> list[str]:
    """Return lines for display: each step, each node, and the critical path. All times in s on one clock."""
    lines = ["start-up:"]
    chain = []
    before = born
    for step, end in steps:
        chain.append(f"{step} {end - before:.2f} s")
        lines.append(f"  {end - born:7.2f} s  {step} ({end - before:.2f} s)")
        before = end
    for name in sorted(started, key=lambda name: up.get(name, float("inf"))):
        if name in up:
            lines.append(f"  {up[name] - born:7.2f} s  {name} up, {up[name] - started[name]:.2f} s after its start")
        else:
            lines.append(f"        -    {name} never was up, started at {started[name] - born:.2f} s")
    if up:
        last = max(up, key=lambda name: up[name])
        begun = started.get(last, before)
        chain += [f"{last} started {max(0.0, begun - before):.2f} s", f"up {up[last] - begun:.2f} s"]
        lines.append(f"  critical chain: {', '.join(chain)}: {up[last] - born:.2f} s in all")
    return lines
