"""Turns of a lidar from its beams: scans in the frame and with the angles that the base file gives. Pure."""

import math
from dataclasses import replace

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from ur.robot.base import Lidar
from ur_nodes.drivers.readings import MeasuredBeams
from ur_nodes.ports.values import Scan

_LONGEST = 0.9  # turns between two tables that have a beam in common which was not measured again
_LEAST_BEAMS = 8  # beams that were measured again, which show where the head is


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
    if most < _LEAST_BEAMS:
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


_SECOND = 1e9  # ns
_FULL = 2.0 * math.pi
_LEAST = 0.5  # of the beams of the base file that have to be there
_GAP = 300_000_000  # ns without beams, after which the turn that was begun is left out


class TurnCollector:
    """Collects beams; each turn that is complete is a scan. What was seen of the first, partial one is left out.

    A scan begins where the base file's `angle_min` is, so that `stamp` is the time of its first beam (REP 117: of the
    array's first) and `time_increment` that between two of them: negative for a lidar that turns clockwise, which
    measures the first of the array last.
    """

    def __init__(self, lidar: Lidar, offset: float = 0.0) -> None:
        """`offset` (rad, counter-clockwise) is where the device's own zero is in the frame of the lidar."""
        self._lidar, self._offset = lidar, offset
        self._increment = (lidar.angle_max - lidar.angle_min) / (lidar.samples - 1)
        self._ranges, self._intensities = self._empty()
        self._bright = False
        self._last: float | None = None  # the angle from the cut, in the direction in which it turns
        self._begun: float | None = None  # ns
        self._stamp = 0  # of the last beams
        self._turn_time = 1.0 / lidar.rate  # s; of the last turn
        self._head = TableHead()

    def forget(self) -> None:
        """The device was away: the turn that was begun is left out."""
        self._last = self._begun = None

    def add(self, beams: MeasuredBeams, stamp: int) -> list[Scan]:
        """Take beams that arrived at a time (ns); return the scans that they complete."""
        if not len(beams.phases):
            return []
        if beams.complete:
            return self._on_table(beams, stamp)
        if not 0 <= stamp - self._stamp <= _GAP:
            self.forget()
        self._stamp = stamp
        turn_time = beams.turn_time or self._turn_time
        sign = -1.0 if beams.clockwise else 1.0
        angles = sign * beams.phases + self._offset
        edge = (self._lidar.angle_max if beams.clockwise else self._lidar.angle_min) - sign * self._increment / 2.0
        passed = (sign * (angles - edge)) % _FULL
        ago = ((passed[-1] - passed) % _FULL + beams.behind) / _FULL * turn_time + beams.sending
        times = stamp - ago * _SECOND
        before = passed[0] if self._last is None else self._last
        cuts = np.flatnonzero(np.diff(passed, prepend=before) < -math.pi)
        scans, at = [], 0
        for cut in (*cuts.tolist(), len(passed)):
            self._put(angles[at:cut], beams.ranges[at:cut], beams.intensities[at:cut])
            if cut == len(passed):
                break
            scans += self._finish(float(times[cut]), clockwise=beams.clockwise)
            self._begun, at = float(times[cut]), cut
        self._last = float(passed[-1])
        return scans

    def _on_table(self, table: MeasuredBeams, stamp: int) -> list[Scan]:
        """Take what is new in a table; where that is not known, each beam was measured half a turn ago, on average."""
        found = self._head.follow(table, stamp)
        if found:
            new, beyond = found
            arrays = (table.phases[new], table.ranges[new], table.intensities[new])
            behind = beyond * _FULL / len(table.phases)
            return self.add(MeasuredBeams(*arrays, table.clockwise, table.turn_time, behind), stamp)
        angles = (-table.phases if table.clockwise else table.phases) + self._offset
        self._put(angles, table.ranges, table.intensities)
        self._begun = stamp - table.turn_time * _SECOND
        middle = stamp - round((stamp - self._begun) / 2.0)
        scans = self._finish(float(stamp), clockwise=table.clockwise)
        self.forget()
        return [replace(scan, stamp=middle, time_increment=0.0) for scan in scans]

    def _put(self, angles: NDArray[np.float64], ranges: NDArray[np.float64], intensities: NDArray[np.float64]) -> None:
        steps = ((angles - self._lidar.angle_min) % _FULL) / self._increment
        index = np.rint(steps).astype(np.int64) % round(_FULL / self._increment)
        inside = index < self._lidar.samples
        lidar, index, ranges = self._lidar, index[inside], ranges[inside]
        far, near = ranges > lidar.range_max, ranges < lidar.range_min
        self._ranges[index] = np.where(far, np.inf, np.where(near, -np.inf, ranges))
        if len(intensities):
            self._bright = True
            self._intensities[index] = intensities[inside]

    def _finish(self, end: float, *, clockwise: bool) -> list[Scan]:
        ranges, intensities, begun = self._ranges, self._intensities, self._begun
        self._ranges, self._intensities = self._empty()
        there = np.count_nonzero(~np.isnan(ranges))
        if begun is None or end <= begun or there < _LEAST * len(ranges):
            return []
        self._turn_time = (end - begun) / _SECOND
        lidar, step = self._lidar, (end - begun) / _SECOND / (_FULL / self._increment)
        first = begun + (lidar.samples - 1) * step * _SECOND if clockwise else begun
        return [
            Scan(
                round(first),
                lidar.frame,
                lidar.angle_min + lidar.askew,
                self._increment,
                lidar.range_min,
                lidar.range_max,
                ranges,
                intensities if self._bright else np.zeros(0, np.float32),
                scan_time=self._turn_time,
                angle_max=lidar.angle_max + lidar.askew,
                time_increment=-step if clockwise else step,
            )
        ]

    def _empty(self) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        size = self._lidar.samples
        return np.full(size, np.nan, np.float32), np.zeros(size, np.float32)
