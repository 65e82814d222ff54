"""Medians and worst values of the drives of several seeds, beside the limits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

_COMMON = {"live m": 0.02, "scan ms": 60.0, "core %": 25.0, "memory MB": 150.0, "lost": 0.0}
_LIMITS: Mapping[str, Mapping[str, float]] = {
    "office": {"final m": 0.008, "farthest m": 0.03, "F": 0.97, **_COMMON},
    "maze": {"final m": 0.006, "farthest m": 0.03, "F": 0.90, **_COMMON},
    "lab": {"final m": 0.006, "farthest m": 0.016, "F": 0.93, **_COMMON},
    "office, poor sensors": {"final m": 0.07, "farthest m": 0.18, "F": 0.75},
    "maze, poor sensors": {"final m": 0.08, "farthest m": 0.20, "F": 0.70},
}
_MORE_IS_BETTER = frozenset({"F"})


@dataclass(frozen=True, slots=True)
class Drive:
    """The figures of one simulated drive, by their names; `log` names its world and its sensors."""

    log: str
    figures: Mapping[str, float]


def summarise(drives: Sequence[Drive]) -> list[str]:
    """A line for each figure of each kind of drive: median, worst, and the limit, marked where the median misses it."""
    lines = []
    for log in dict.fromkeys(each.log for each in drives):
        same = [each.figures for each in drives if each.log == log]
        lines.append(f"{log}, {len(same)} drives:")
        for name in same[0]:
            values = np.array([figures[name] for figures in same])
            middle, more = float(np.median(values)), name in _MORE_IS_BETTER
            worst = float(values.min() if more else values.max())
            limit = _LIMITS.get(log, {}).get(name)
            line = f"  {name:12} median {middle:8.4g}  worst {worst:8.4g}"
            if limit is not None:
                missed = middle < limit if more else middle > limit
                line += f"  limit {limit:g}{'  MISSED' if missed else ''}"
            lines.append(line)
    return lines
