"""Odd values of any kind: usable ones with one field, found by name, replaced by what no program should send."""

import math
import types
import typing
from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace
from typing import Any

import numpy as np

from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2, Pose3
from ur_nodes.ports import actions, fiducials, services, values

FLOATS = (math.nan, math.inf, -math.inf, 1e308, -1e308, 1e300, 1e17, -0.0, 0.0, 1e-320)
INTEGERS = (0, -1, 1 << 31, 1 << 63, -(1 << 63), 10**30)
TEXTS = ("", "x" * 50_000, "\0\x1b]0;title\7\n", "../../etc/passwd", '{"a":' * 1000)
SHAPES = {
    "values": (40, 50),
    "covariance": (3, 3),
    "pose_covariance": (3, 3),
    "twist_covariance": (3, 3),
    "poses": (5, 3),
    "corners": (4, 2),
    "colours": (16, 4),
}
"""Of arrays by the names of their fields; those of `points` are (16, 3), others (16)."""

LENGTHS = {"distortion": 5, "matrix": 9, "rectification": 9, "projection": 12}
"""Likewise of tuples; others 3."""

NUMBERS = {
    "range_min": 0.05,
    "range_max": 8.0,
    "range": 1.0,
    "angle_min": -math.pi,
    "angle_increment": 0.4,
    "resolution": 0.1,
    "intensities": np.zeros(0, np.float32),
}
"""Values by the names of their fields; other numbers are 0."""

_MODULES = (values, fiducials, services, actions)
_POINTS = np.zeros(16, [("x", "<f4"), ("y", "<f4"), ("z", "<f4")])


def usable_value(kind: Any, stamp: int, frame: str, name: str = "") -> Any:
    """A value of a kind that a node can use, at rest and without a request for motion."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if kind is tuple:
        return (values.Transform(stamp, frame, "odd", Pose3(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)),)
    if origin in (typing.Union, types.UnionType):
        return usable_value(arguments[0], stamp, frame, name)
    if origin is typing.Literal:
        return arguments[0]
    if origin is tuple:
        if len(arguments) == 4 and set(arguments) == {float}:
            return (0.0, 0.0, 0.0, 1.0)
        repeated = arguments[:1] * LENGTHS.get(name, 3) if arguments[-1] is ... else arguments
        return tuple(usable_value(each, stamp, frame) for each in repeated)
    if kind in (Pose2, Pose3):
        return Pose2(0.0, 0.0, 0.0) if kind is Pose2 else Pose2(0.0, 0.0, 0.0).in_space()
    if origin is np.ndarray:
        return _usable_array(typing.get_args(arguments[1])[0], name)
    if is_dataclass(kind):
        hints = hints_of(typing.cast("type", kind))
        made = {each: usable_value(hint, stamp, frame, each) for each, hint in hints.items()}
        return typing.cast("Any", kind)(**made | {each: NUMBERS[each] for each in made if each in NUMBERS})
    plain = {float: 0.0, int: stamp if name == "stamp" else 1, bool: False, bytes: b""}
    return plain.get(kind, frame if name == "frame" else "odd")


def _usable_array(number: Any, name: str) -> Any:
    if number is np.void:
        return _POINTS
    made = np.zeros(SHAPES.get(name, (16, 3) if name == "points" else (16,)), number)
    if made.dtype == np.int8:
        made[:2] = 100  # a wall
    return np.ones_like(made) if name == "ranges" else made


def hints_of(kind: type) -> dict[str, Any]:
    """The types of a dataclass's fields by their names."""
    known = {name: each for module in _MODULES for name, each in vars(module).items()}
    module = vars(__import__(kind.__module__, fromlist=["*"]))
    hints = typing.get_type_hints(kind, {**known, **module, "Pose2": Pose2, "Pose3": Pose3, "Grid": Grid})
    return {each.name: hints[each.name] for each in fields(kind)}


def odd_values(kind: Any, value: Any, name: str = "") -> Iterator[Any]:
    """All values that differ from a usable one of a kind in one field, at any depth, which is odd."""
    arguments = typing.get_args(kind)
    if isinstance(value, bool):
        yield not value
    elif isinstance(value, (float, int, str, bytes)):
        yield from {float: FLOATS, int: INTEGERS, str: TEXTS, bytes: (b"", b"\xff" * 50_000)}[type(value)]
    elif isinstance(value, np.ndarray):
        yield from _odd_arrays(value, fixed=name.endswith("covariance"))
    elif is_dataclass(value) and not isinstance(value, type):
        for field, hint in hints_of(type(value)).items():
            for odd in odd_values(hint, getattr(value, field), field):
                yield replace(value, **{field: odd})
    elif isinstance(value, tuple):
        item = arguments[0] if arguments else float
        for index, each in enumerate(value):
            for odd in odd_values(item, each):
                changed = (*value[:index], odd, *value[index + 1 :])
                yield type(value)(*changed) if hasattr(value, "_fields") else changed
        if kind is tuple or arguments[1:] == (...,):  # of any length
            yield from ((), value[1:], value * 1000)


def _odd_arrays(value: Any, *, fixed: bool) -> Iterator[Any]:
    if not fixed:
        yield from (value[:0], np.concatenate((value, value)), value[: len(value) // 2])
    if value.dtype.kind == "f" and value.size:
        for number in FLOATS:
            with np.errstate(over="ignore"):
                full = np.full_like(value, number)
                yield full
                one = value.copy()
                one.flat[0] = full.flat[0]
                yield one
    elif value.dtype.kind == "i":
        yield from (np.full_like(value, number) for number in (-128, -1, 101, 127))
