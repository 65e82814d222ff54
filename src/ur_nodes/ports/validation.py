"""Validation of values where they enter a node: one check for the topics and services of all backends.

A message is judged as a whole before it replaces another: one that is refused counts as not sent. The rules are those
of the types of fields, so values of new kinds are judged, too: numbers are finite, coordinates at most `FARTHEST`, and
rotations of length 1. Kinds that report what is not measured as NaN or infinite have rules of their own.

Goals and requests for a path are judged by the node that answers them, see `ur_nodes.navigation.move_base`; each
transform of a message by itself, see `ports.transforms`.
"""

import math
from collections.abc import Callable, Iterable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, Pose3, Quaternion
from ur_nodes.ports import values
from ur_nodes.ports.actions import Goal
from ur_nodes.ports.fiducials import MappedFiducials
from ur_nodes.ports.services import AskPath

Value = TypeVar("Value")

FARTHEST = 1e6
"""m, m/s or rad/s: the greatest coordinate of a pose and the greatest speed."""

UNIT_SLACK = 0.1
"""The greatest difference from 1 of the length of a rotation's quaternion."""

_DRIVER_SLACK = 0.01  # of a program's own; more was misread from a serial line
_NO_ROTATION = "the orientation is not a unit quaternion, expected one (for no rotation: w = 1)"
_LARGEST = 1e12
_WIDEST = 4.0 * math.pi  # rad: the angle of a beam, of a turn that begins at up to a turn
_NARROWEST = 1e-5  # rad from one beam to the next
_LONGEST = 60.0  # s from the first to the last beam
_FINEST, _COARSEST = 1e-4, 1e3  # m: the side of a map's cell
_MOST_PUBLISHERS = 32  # that are reported


def problem_of(value: object, name: str = "data") -> str:
    """Return what is wrong with a value, and what was expected; '' for a usable one."""
    return _RULES.get(type(value), _judge_fields)(name, value)


def usable(value: Value) -> Value:
    """Return a value that has no problem. Raises ValueError with the problem."""
    if problem := problem_of(value):
        raise ValueError(problem)
    return value


class Refusals:
    """Reports messages of a topic that are ignored: each to `callback`, or once for each publisher to `write`."""

    def __init__(
        self, topic: str, write: Callable[[str], object], callback: Callable[[str], None] | None = None
    ) -> None:
        self._topic, self._write, self._take = topic, write, callback
        self._reported: set[str] = set()

    def report(self, problem: str, publisher: str = "") -> None:
        """Report a message of a publisher, '' for an unknown one."""
        if self._take is not None:
            self._take(problem)
        elif publisher not in self._reported and len(self._reported) < _MOST_PUBLISHERS:
            self._reported.add(publisher)
            source = f" of {publisher}" if publisher else ""
            self._write(f"{self._topic}: message{source} ignored: {problem}; help: correct or stop its publisher")


def _judge_fields(name: str, value: object) -> str:
    """Judge the fields of a dataclass; there is nothing to judge in other types."""
    for each in getattr(value, "__dataclass_fields__", ()):
        field = getattr(value, each)
        if problem := _RULES.get(type(field), _judge_fields)(each, field):
            return problem if name == "data" else f"{name}: {problem}"
    return ""


def _judge_items(name: str, items: Iterable[object]) -> str:
    for each in items:
        if problem := problem_of(each, name):
            return problem
    return ""


def _limit(name: str, value: float, most: float = _LARGEST) -> str:
    return "" if abs(value) <= most else f"{name} is {value:g}, not finite or too large; expected at most {most:g}"


def _limit_all(name: str, numbers: Iterable[float]) -> str:
    for each in numbers:
        if not abs(each) <= FARTHEST:
            return _limit(name, each, FARTHEST)
    return ""


def _judge_integer(name: str, value: int) -> str:
    return "" if abs(value) < 1 << 63 else f"{name} is too large, expected a number of 64 bits"


def _judge_array(name: str, value: NDArray[np.floating]) -> str:
    good = value.dtype.kind != "f" or np.vdot(value, value) <= _LARGEST**2 or np.abs(value).max() <= _LARGEST
    return "" if good else f"{name} has a number that is not finite or too large"


def _judge_pose(_name: str, pose: Pose2) -> str:
    return _limit_all("a coordinate", pose[:2]) or ("" if abs(pose.yaw) <= FARTHEST else _NO_ROTATION)


def _judge_rotation(rotation: Quaternion, slack: float = UNIT_SLACK) -> str:
    return "" if abs(math.hypot(*rotation) - 1.0) <= slack else _NO_ROTATION


def _judge_twist(_name: str, twist: values.Twist) -> str:
    return _limit_all("a velocity", (twist.forward, twist.turn, twist.left, twist.up, twist.roll, twist.pitch))


def _judge_scan(_name: str, scan: values.Scan) -> str:
    count, first, step = len(scan.ranges), scan.angle_min, scan.angle_increment
    if not 0.0 <= scan.range_min < scan.range_max:
        return f"range_min is {scan.range_min:g} and range_max {scan.range_max:g}, expected 0 <= range_min < range_max"
    if not (abs(first) <= _WIDEST and abs(first + count * step) <= _WIDEST and abs(step) >= _NARROWEST):
        return f"angle_min is {first:g} and angle_increment {step:g}, expected angles (rad) of {count} beams in a turn"
    if len(scan.intensities) not in (0, count):
        return f"{count} ranges with {len(scan.intensities)} intensities, expected as many or none"
    return _limit("time_increment", scan.time_increment * count, _LONGEST) or _judge_integer("stamp", scan.stamp)


def _judge_range(_name: str, value: values.Range) -> str:
    if not 0.0 <= value.field_of_view <= 2.0 * math.pi:
        return f"field_of_view is {value.field_of_view:g}, expected 0 to 6.28 rad"
    if not 0.0 <= value.range_min <= value.range_max <= FARTHEST:
        return f"min_range is {value.range_min:g} and max_range {value.range_max:g}, expected 0 <= min <= max"
    return _judge_integer("stamp", value.stamp)


def _judge_imu(name: str, imu: values.Imu) -> str:
    parts = (  # sensor_msgs/Imu: with a variance of -1 there is no estimate
        (imu.turning, imu.turning_variance),
        (imu.force, imu.force_variance),
        (imu.orientation, imu.orientation_variance),
    )
    return _judge_items(name, (numbers for numbers, variance in parts if variance != -1.0))


def _judge_joints(_name: str, joints: values.Joints) -> str:
    count, angles, speeds = len(joints.names), len(joints.angles), len(joints.speeds)
    fits = angles == count and speeds in (0, count)
    return "" if fits else f"{count} names with {angles} positions and {speeds} velocities, expected as many"


def _judge_calibration(name: str, value: values.Calibration) -> str:
    lengths = len(value.matrix), len(value.rectification), len(value.projection)
    fits = lengths == (9, 9, 12)
    return _judge_fields(name, value) if fits else f"K, R and P have {lengths} numbers, expected 9, 9 and 12"


def _judge_grid(name: str, grid: Grid) -> str:
    if not _FINEST <= grid.resolution <= _COARSEST:
        return f"map with resolution {grid.resolution:g}, expected {_FINEST:g} to {_COARSEST:g} m"
    return _judge_pose(name, grid.origin) if all(grid.shape) else "map without cells, expected one or more"


_UNMEASURED = (values.Battery, values.Markers, values.MarkerChanges, values.PointCloud, MappedFiducials)
_JUDGED_LATER = (values.Transform, Goal, AskPath)
_RULES: dict[type, Callable[..., str]] = {
    float: _limit,
    int: _judge_integer,
    tuple: _judge_items,
    np.ndarray: _judge_array,
    Pose2: _judge_pose,
    Pose3: lambda _name, pose: _limit_all("a coordinate", pose[:3]) or _judge_rotation(pose.rotation),
    Grid: _judge_grid,
    values.Twist: _judge_twist,
    values.StampedTwist: lambda name, value: _judge_twist(name, value.twist) or _judge_integer("stamp", value.stamp),
    values.DriverOdometry: lambda name, of: _judge_rotation(of.rotation, _DRIVER_SLACK) or _judge_fields(name, of),
    values.Scan: _judge_scan,
    values.Range: _judge_range,
    values.Imu: _judge_imu,
    values.Joints: _judge_joints,
    values.Calibration: _judge_calibration,
    **dict.fromkeys((str, bool, bytes, type(None), *_UNMEASURED, *_JUDGED_LATER), lambda _name, _value: ""),
}
