"""The heading of a robot by its gyroscope, used if the scans show that it is more accurate than the wheels."""

import math
from bisect import bisect_left
from collections import deque

from ur_nodes.geometry.pose import Pose2, wrap_angle

_KEPT = 20.0  # s of yaw rates
_GAP = 0.2  # s between two yaw rates: what happened in between is not known
_STILL = (0.001, 0.001)  # m, rad between two scans: the wheels do not turn
_MOST_BIAS = 0.1  # rad/s: more at rest means that the robot is being turned
_MEMORY = 50  # measurements of the bias that count
_WINDOW = 10  # scans over which turns are compared, since each scan's own noise is as large as the difference
_LEAD = 0.1  # rad by which the errors of the wheels must be larger
_CONTRADICTION = 3.0, 0.5  # times the errors of the wheels, and rad, from which on a gyroscope is wrong
_FADING = 100  # windows after which all errors so far count half


class Gyro:
    """Yaw rates of the robot, and their integral. The bias is learned while the robot is at rest."""

    def __init__(self) -> None:
        self.bias = 0.0
        """The yaw rate (rad/s) that the gyroscope reports at rest."""
        self._times: deque[float] = deque()
        self._sums: deque[float] = deque()  # rad turned since the first one, bias included
        self._broken = -math.inf  # the time of the last gap's end
        self._rate = 0.0
        self._rests = 0

    def add(self, stamp: float, rate: float) -> None:
        """Add a yaw rate (rad/s, counter-clockwise) at a time in s; an earlier time restarts the integral."""
        last = self._times[-1] if self._times else None
        if last is not None and stamp <= last:
            self._times.clear()
            self._sums.clear()
            last = None
        if last is None or stamp - last > _GAP:
            self._broken = stamp
        before = self._sums[-1] if last is not None else 0.0
        turned = 0.5 * (rate + self._rate) * (stamp - last) if last is not None else 0.0
        self._times.append(stamp)
        self._sums.append(before + turned)
        self._rate = rate
        while self._times[0] < stamp - _KEPT:
            self._times.popleft()
            self._sums.popleft()

    def rest(self, begin: float, end: float) -> None:
        """Learn the bias from an interval in which the robot did not move."""
        raw = self._raw_turn(begin, end)
        if raw is None or end <= begin or abs(raw / (end - begin)) > _MOST_BIAS:
            return
        self._rests = min(self._rests + 1, _MEMORY)
        self.bias += (raw / (end - begin) - self.bias) / self._rests

    def turn(self, begin: float, end: float) -> float | None:
        """Return the turn (rad) between two times; None if yaw rates are missing."""
        raw = self._raw_turn(begin, end)
        return raw - self.bias * (end - begin) if raw is not None else None

    def _raw_turn(self, begin: float, end: float) -> float | None:
        if not self._times or begin < self._broken or begin < self._times[0] or begin > end:
            return None
        if end > self._times[-1] + _GAP:
            return None
        return self._sum_at(end) - self._sum_at(begin)

    def _sum_at(self, stamp: float) -> float:
        after = bisect_left(self._times, stamp)
        if after == len(self._times):
            return self._sums[-1] + self._rate * (stamp - self._times[-1])
        if after == 0:
            return self._sums[0]
        earlier, later = self._times[after - 1], self._times[after]
        share = (stamp - earlier) / (later - earlier)
        return self._sums[after - 1] + share * (self._sums[after] - self._sums[after - 1])


class Headings:
    """The robot's heading by a gyroscope, once the scans have shown that it is more accurate than the wheels."""

    def __init__(self) -> None:
        self.gyro = Gyro()
        self._last: tuple[float, Pose2] | None = None  # time and odometry of the last scan
        self._heading = 0.0
        self._turned = 0.0  # since the scan that was judged last
        self._known = False  # whether all of that comes from yaw rates
        self._window: list[tuple[float, float, float]] = []  # turns by gyroscope, wheels and scans
        self._errors = [0.0, 0.0]  # rad, of gyroscope and wheels
        self._windows = 0

    @property
    def trusted(self) -> bool:
        """Return whether the gyroscope is more accurate than the wheels."""
        return self._errors[0] + _LEAD < self._errors[1]

    @property
    def contradicted(self) -> bool:
        """Return whether the gyroscope is much less accurate than the wheels: its frame or its sign may be wrong."""
        times, least = _CONTRADICTION
        return self._errors[0] > max(times * self._errors[1], least)

    def at(self, stamp: float, odometry: Pose2) -> float | None:
        """Return the heading (rad, from an arbitrary origin) at a scan; None while it is unknown or not trusted."""
        before, self._last = self._last, (stamp, odometry)
        if before is None:
            self._known = False
            return None
        motion = before[1].inverse().compose(odometry)
        turn = self.gyro.turn(before[0], stamp)
        if math.hypot(motion.x, motion.y) < _STILL[0] and abs(motion.yaw) < _STILL[1]:
            self.gyro.rest(before[0], stamp)
            turn = 0.0
        if turn is None:
            self._known = False
            return None
        self._heading += turn
        self._turned += turn
        return self._heading if self.trusted and self._known else None

    def judge(self, shown: Pose2 | None, wheels: Pose2 | None) -> None:
        """Compare the turn since the last call with the motion by the scans and by the wheels; None: not known."""
        turned, known, self._turned, self._known = self._turned, self._known, 0.0, True
        if shown is None or wheels is None or not known:
            self._window.clear()
            return
        self._window.append((turned, wheels.yaw, shown.yaw))
        if len(self._window) < _WINDOW:
            return
        by_gyro, by_wheels, by_scans = (math.fsum(each) for each in zip(*self._window, strict=True))
        self._window.clear()
        self._errors[0] += abs(wrap_angle(by_gyro - by_scans))
        self._errors[1] += abs(wrap_angle(by_wheels - by_scans))
        self._windows += 1
        if self._windows % _FADING == 0:
            self._errors = [each / 2.0 for each in self._errors]
