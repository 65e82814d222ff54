"""The head of a lidar that keeps a table of its last turn: where it was when the table was read. Pure."""

import math

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from ur_nodes.drivers.readings import MeasuredBeams

_SECOND = 1e9  # ns
_LONGEST = 0.9  # turns between two tables that have a beam in common which was not measured again
_LEAST = 8  # beams that were measured again, which show where the head is


class TableHead:
    """Follows a head by the beams of a table that differ from the last one: a beam that is measured again differs.

    Where beams found nothing, before and after, the head is where its rate has it by now.
    """

    def __init__(self) -> None:
        self._rows: NDArray[np.float64] | None = None
        self._stamp = 0
        self._place: float | None = None  # beams from the first one of the table on

    def follow(self, table: MeasuredBeams, stamp: int) -> tuple[NDArray[np.int64], float] | None:
        """Take a table that was read at a time (ns).

        Returns the beams (n,) that were measured since the last one, by their places in the table and in the order in
        which they were measured, and the share of a beam that the head has turned on since; None: nothing shows it.
        """
        rows, last = np.stack((table.ranges, table.intensities)), self._rows
        turns = (stamp - self._stamp) / _SECOND / table.turn_time
        self._rows, self._stamp, before = rows, stamp, self._place
        self._place = None
        if last is None or not 0.0 < turns < _LONGEST:
            return None
        size = rows.shape[1]
        due = None if before is None else before + turns * size
        changed = (rows != last).any(axis=0)
        found = _locate(np.where(changed, 1, np.where(np.isfinite(table.ranges), -1, 0)))
        self._place = due if found is None else _choose(due, *found, size)
        if self._place is None or before is None:
            return None
        self._place %= size
        count = (math.floor(self._place) - math.floor(before)) % size
        return (math.floor(before) + np.arange(count)) % size, self._place % 1.0


def _locate(weights: NDArray[np.int64]) -> tuple[float, float] | None:
    """Find from where to where the head may be, by the arc of most weight that ends there; None: no arc has enough.

    Weights (n,): 1 for a beam that was measured again, -1 for one that was not, 0 for one that does not tell.
    """
    size = len(weights)
    sums = np.concatenate(([0], np.cumsum(np.tile(weights, 2)))).astype(np.int16)
    arcs = sliding_window_view(sums[:-1], size + 1) - sums[:size, None]
    begin, length = divmod(int(np.argmax(arcs)), size + 1)
    most = arcs[begin, length]
    if most < _LEAST:
        return None
    less = np.flatnonzero(arcs[begin, length:] < most)
    more = int(less[0]) if len(less) else size + 1 - length
    return float(begin + length), float(begin + length + more)


def _choose(due: float | None, low: float, high: float, size: int) -> float:
    """The place where the head is due, or the nearest one from `low` to `high`."""
    if due is None:
        return low
    after = (due - low) % size
    if after < high - low:
        return low + after
    return low if size - after < after - (high - low) else math.nextafter(high, low)
