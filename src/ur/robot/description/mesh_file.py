"""Mesh files (STL, Collada, OBJ) as their outermost points, in the units of a URDF.

Files are measured, not displayed: a file that is no mesh, or too large for one of a robot, has no points. Files are
read in chunks, so that memory use does not grow with their size.
"""

import math
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from itertools import product
from pathlib import Path
from typing import IO
from xml.etree.ElementTree import Element

import numpy as np
from numpy.typing import NDArray

from ur.source.foreign.files import open_file
from ur.source.foreign.xml_text import parse_xml

Points = NDArray[np.float64]  # (n, 3)

LARGEST = 200_000_000  # bytes of a file
_LARGEST_COLLADA = 32_000_000  # bytes; such files are read as a whole
# Limits of a Collada scene, whose nodes may refer to each other:
_DEEPEST, _MOST_NODES, _MOST_POINTS = 32, 10_000, 10_000_000
_HEADER, _FACET = 84, 50  # bytes of a binary STL
_PIECE = 1 << 20  # bytes that are read at once
_BLOCK = 2_000  # points that are compared at once
_FARTHEST = 1e9
_TURNS = 32  # directions in each plane of two axes


class _Hull:
    """The outermost points in many directions, of all points that were added."""

    def __init__(self) -> None:
        turns = [2.0 * math.pi * n / _TURNS for n in range(_TURNS)]
        level = [np.array([math.cos(turn), math.sin(turn), 0.0]) for turn in turns]
        slanted = [np.array(signs) for signs in product((-1.0, 1.0), repeat=3)]
        self._directions = np.array([*(np.roll(each, shift) for each in level for shift in range(3)), *slanted])
        self._reach = np.full(len(self._directions), -np.inf)
        self._points = np.zeros((len(self._directions), 3))

    def add(self, points: Points) -> None:
        for start in range(0, len(points), _BLOCK):
            block = points[start : start + _BLOCK]
            block = block[(np.abs(block) < _FARTHEST).all(axis=1)]  # False for NaN
            if not len(block):
                continue
            reach = self._directions @ block.T
            outermost = reach.argmax(axis=1)
            best = reach[np.arange(len(outermost)), outermost]
            farther = best > self._reach
            self._reach[farther] = best[farther]
            self._points[farther] = block[outermost[farther]]

    def points(self) -> Points:
        found: Points = np.unique(self._points[np.isfinite(self._reach)], axis=0)
        return found


def read_mesh(path: Path) -> Points:
    """Return the outermost points of a mesh; none if the file does not exist or has an unknown format."""
    hull = _Hull()
    try:
        with open_file(path, LARGEST) as file:
            for points in _READERS[path.suffix.lower()](file):
                hull.add(points)
    except (OSError, ValueError, KeyError):
        return np.empty((0, 3))
    return hull.points()


def _read_stl(file: IO[bytes]) -> Iterator[Points]:
    size = file.seek(0, 2)
    file.seek(0)
    head = file.read(_HEADER)
    count = int.from_bytes(head[80:], "little")
    if len(head) < _HEADER or size != _HEADER + _FACET * count:
        file.seek(0)
        yield from _read_rows(file, re.compile(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)"))
        return
    facet = np.dtype([("numbers", "<f4", 12), ("rest", "<u2")])
    while data := file.read(_PIECE // _FACET * _FACET):
        facets = np.frombuffer(data, facet, len(data) // _FACET)
        yield facets["numbers"][:, 3:].reshape(-1, 3).astype(np.float64)


def _read_obj(file: IO[bytes]) -> Iterator[Points]:
    yield from _read_rows(file, re.compile(rb"^v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE))


def _read_rows(file: IO[bytes], row: re.Pattern[bytes]) -> Iterator[Points]:
    """Yield the numbers of matching rows, in chunks of whole lines. Raises ValueError."""
    rest = b""
    while data := file.read(_PIECE):
        lines, _, rest = (rest + data).rpartition(b"\n")
        if len(rest) > _PIECE:
            raise ValueError("a line of a mesh is too long")
        yield _numbers(row.findall(lines))
    yield _numbers(row.findall(rest))


def _numbers(words: list[tuple[bytes, bytes, bytes]]) -> Points:
    return np.array([[float(word) for word in row] for row in words], dtype=np.float64).reshape(-1, 3)


def _read_collada(file: IO[bytes]) -> Iterator[Points]:
    """Yield the points of a scene, with the transforms of its nodes; as in RViz, without a rotation for the up axis."""
    root = parse_xml(file.read(_LARGEST_COLLADA + 1), length=_LARGEST_COLLADA)
    for element in root.iter():
        element.tag = str(element.tag).rpartition("}")[2]
    unit = root.find("asset/unit")
    scale = float(unit.get("meter", "1")) if unit is not None else 1.0
    geometries = {each.get("id", ""): _positions(each) * scale for each in root.iter("geometry")}
    empty = True
    for points in _place(root, geometries, scale):
        empty = False
        yield points
    if empty:
        yield from geometries.values()


def _place(root: Element, geometries: Mapping[str, Points], scale: float) -> Iterator[Points]:
    """Yield the geometries that the nodes of a scene place. Raises ValueError if there are too many."""
    named = {each.get("id", ""): each for each in root.iter("node")}
    left = [(node, np.eye(4), 0) for node in root.findall("library_visual_scenes/visual_scene/node")]
    nodes = points = 0
    while left:
        node, outer, depth = left.pop()
        nodes += 1
        if nodes > _MOST_NODES or points > _MOST_POINTS or depth > _DEEPEST:
            raise ValueError("the nodes of a Collada scene are too many")
        here = outer @ _transform(node, scale)
        for child in node:
            name = child.get("url", "").removeprefix("#")
            if child.tag == "node":
                left.append((child, here, depth + 1))
            elif child.tag == "instance_node" and name in named:
                left.append((named[name], here, depth + 1))
            elif child.tag == "instance_geometry" and name in geometries:
                points += len(geometries[name])
                yield geometries[name] @ here[:3, :3].T + here[:3, 3]


def _transform(node: Element, scale: float) -> NDArray[np.float64]:
    """Return the product of a node's own transforms, in the order of the file, with lengths in m."""
    whole = np.eye(4)
    for child in node:
        if child.tag not in ("matrix", "translate", "scale", "rotate"):
            continue
        numbers = _read_floats(child.text)
        one = np.eye(4)
        if child.tag == "matrix":
            one = numbers.reshape(4, 4)
            one[:3, 3] *= scale
        elif child.tag == "translate":
            one[:3, 3] = numbers * scale
        elif child.tag == "scale":
            one[:3, :3] = np.diag(numbers.reshape(3))
        else:
            x, y, z, angle = numbers
            one[:3, :3] = _turn(np.array((x, y, z)), math.radians(angle))
        whole = whole @ one
    return whole


def _turn(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """Return a rotation about an axis (Rodrigues)."""
    x, y, z = axis / (np.linalg.norm(axis) or 1.0)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: NDArray[np.float64] = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
    return rotation


def _positions(geometry: Element) -> Points:
    """Return the vertex positions of a geometry: the source that its `vertices` name."""
    named = geometry.find("mesh/vertices/input[@semantic='POSITION']")
    if named is None:
        return np.empty((0, 3))
    for source in geometry.findall("mesh/source"):
        if source.get("id") == named.get("source", "").removeprefix("#"):
            accessor = source.find("technique_common/accessor")
            stride = int(accessor.get("stride", "3")) if accessor is not None else 3
            if stride < 3:
                break
            numbers = _read_floats(source.findtext("float_array"))
            return numbers[: len(numbers) // stride * stride].reshape(-1, stride)[:, :3]
    return np.empty((0, 3))


def _read_floats(text: str | None) -> NDArray[np.float64]:
    """Parse numbers separated by whitespace into an array. Raises ValueError."""
    with warnings.catch_warnings():
        warnings.simplefilter("error", DeprecationWarning)  # older NumPy warns for a text that is no number
        try:
            numbers: NDArray[np.float64] = np.fromstring((text or "").strip(), dtype=np.float64, sep=" ")
        except DeprecationWarning as problem:
            raise ValueError(str(problem)) from None
    return numbers


_READERS: Mapping[str, Callable[[IO[bytes]], Iterator[Points]]] = {
    ".stl": _read_stl,
    ".dae": _read_collada,
    ".obj": _read_obj,
}
SUFFIXES = tuple(_READERS)
