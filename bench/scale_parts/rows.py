"""Rows of bench/scale: the cost of one kind of work at one size, and the exponent with which it grows.

A subject of the bench is a module `bench/scale_parts/SUBJECT.py`. It has
    a docstring, whose first line `bench/scale --help` shows;
    SIZES: tuple[int, ...]   the sizes that are measured unless others are asked for, four or more, ascending
    SIZE: str                the thing that a size counts, as "launch files"
    PEER: str                the program beside it, as "roslaunch-check", or ""
    measure(sizes: Sequence[int]) -> Iterable[Row]
`measure` may yield its rows one by one, which are printed as they come. It ends and removes what it started and made.
One subject may have several kinds of work: each has a `subject` of its own in its rows, as "workspaces: ur check".
"""

import math
import os
import subprocess
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Row:
    """The cost of one kind of work at one size; a cost that grows is worse (seconds per thing, not things per second).

    `peer` is the cost of the same work in the peer, in the same unit; None where it has none or was not measured.
    """

    subject: str
    size: float
    cost: float
    unit: str
    peer: float | None = None


@dataclass(frozen=True, slots=True)
class Usage:
    """The cost of one process with those that it has waited for: seconds, and its largest memory in MB (10^6 bytes)."""

    processor: float
    elapsed: float
    memory: float
    code: int


def fit_exponent(pairs: Iterable[tuple[float, float]]) -> float | None:
    """Fit e in cost = a * size^e by least squares of the logarithms; None with fewer than two sizes above zero."""
    points = [(math.log(size), math.log(cost)) for size, cost in pairs if size > 0 and cost > 0]
    if len({x for x, _ in points}) < 2:
        return None
    mean_x = sum(x for x, _ in points) / len(points)
    mean_y = sum(y for _, y in points) / len(points)
    return sum((x - mean_x) * (y - mean_y) for x, y in points) / sum((x - mean_x) ** 2 for x, _ in points)


def measure_command(command: Sequence[str], environment: Mapping[str, str], folder: str | None = None) -> Usage:
    """Run a command to its end, without its output, and return its cost."""
    start = time.perf_counter()
    process = subprocess.Popen(
        list(command), env=dict(environment), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        _, status, usage = os.wait4(process.pid, 0)
    except BaseException:
        process.kill()
        process.wait()
        raise
    process.returncode = os.waitstatus_to_exitcode(status)
    elapsed = time.perf_counter() - start
    return Usage(usage.ru_utime + usage.ru_stime, elapsed, usage.ru_maxrss * 1024 / 1e6, process.returncode)
