"""Mesh files (STL, Collada, OBJ) as points, in the units of a URDF.

Files are measured, not shown: what is no mesh, or is too large to be one of a robot, has no points.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]  # (n, 3)

_LARGEST = 200_000_000  # bytes
_DEEPEST, _MOST_INSTANCES = 32, 10_000  # of nodes in a Collada scene, which may name one another in a loop
_HEADER, _FACET = 84, 50  # bytes of a binary STL


def read_mesh(path: Path) -> Points:
    """The points of a mesh; none where the file is not there, or is none of the known kinds."""
    try:
        if not path.is_file() or path.stat().st_size > _LARGEST:
            return _none()
        data = path.read_bytes()
        points: Points = _READERS[path.suffix.lower()](data)
    except (OSError, ValueError, KeyError, ElementTree.ParseError):
        return _none()
    finite: Points = points[np.isfinite(points).all(axis=1)]
    return finite


def _none() -> Points:
    return np.empty((0, 3))


def _read_stl(data: bytes) -> Points:
    count = int.from_bytes(data[80:_HEADER], "little")
    if len(data) >= _HEADER and len(data) == _HEADER + _FACET * count:
        facets = np.frombuffer(data, np.dtype([("numbers", "<f4", 12), ("rest", "<u2")]), count, _HEADER)
        return facets["numbers"][:, 3:].reshape(-1, 3).astype(np.float64)
    return _numbers(re.findall(rb"\bvertex\s+(\S+)\s+(\S+)\s+(\S+)", data))


def _read_obj(data: bytes) -> Points:
    return _numbers(re.findall(rb"^v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", data, re.MULTILINE))


def _numbers(words: list[tuple[bytes, bytes, bytes]]) -> Points:
    return np.array([[float(word) for word in row] for row in words], dtype=np.float64).reshape(-1, 3)


def _read_collada(data: bytes) -> Points:
    """The points of a scene, with the turns and scales of its nodes; as RViz, without a turn to another upward axis."""
    if re.search(rb"<!(DOCTYPE|ENTITY)", data):
        return _none()
    root = ElementTree.fromstring(data)  # noqa: S314 - without a document type there are no entities
    for element in root.iter():
        element.tag = str(element.tag).rpartition("}")[2]
    geometries = {each.get("id", ""): _positions(each) for each in root.iter("geometry")}
    nodes = {each.get("id", ""): each for each in root.iter("node")}
    placed = (
        points
        for scene in root.findall("library_visual_scenes/visual_scene")
        for node in scene.findall("node")
        for points in _instances(node, np.eye(4), geometries, nodes, _DEEPEST)
    )
    found = list(islice(placed, _MOST_INSTANCES))
    unit = root.find("asset/unit")
    scale = float(unit.get("meter", "1")) if unit is not None else 1.0
    return np.concatenate([_none(), *(found or geometries.values())]) * scale


def _instances(
    node: ElementTree.Element,
    outer: NDArray[np.float64],
    geometries: Mapping[str, Points],
    nodes: Mapping[str, ElementTree.Element],
    depth: int,
) -> Iterator[Points]:
    if depth == 0:
        return
    here = outer @ _transform(node)
    for child in node:
        name = child.get("url", "").removeprefix("#")
        if child.tag == "node":
            yield from _instances(child, here, geometries, nodes, depth - 1)
        elif child.tag == "instance_node" and name in nodes:
            yield from _instances(nodes[name], here, geometries, nodes, depth - 1)
        elif child.tag == "instance_geometry" and name in geometries:
            yield geometries[name] @ here[:3, :3].T + here[:3, 3]


def _transform(node: ElementTree.Element) -> NDArray[np.float64]:
    """The product of a node's own transforms, in the order of the file."""
    whole = np.eye(4)
    for child in node:
        if child.tag not in ("matrix", "translate", "scale", "rotate"):
            continue
        numbers = [float(word) for word in (child.text or "").split()]
        one = np.eye(4)
        if child.tag == "matrix":
            one = np.array(numbers).reshape(4, 4)
        elif child.tag == "translate":
            one[:3, 3] = numbers
        elif child.tag == "scale":
            one[:3, :3] = np.diag(numbers)
        else:
            x, y, z, angle = numbers
            one[:3, :3] = _turn(np.array((x, y, z)), math.radians(angle))
        whole = whole @ one
    return whole


def _turn(axis: NDArray[np.float64], angle: float) -> NDArray[np.float64]:
    """A rotation about an axis (Rodrigues)."""
    x, y, z = axis / (np.linalg.norm(axis) or 1.0)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: NDArray[np.float64] = np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * (cross @ cross)
    return rotation


def _positions(geometry: ElementTree.Element) -> Points:
    """The places of a geometry's corners: the source that its `vertices` name."""
    named = geometry.find("mesh/vertices/input[@semantic='POSITION']")
    if named is None:
        return _none()
    for source in geometry.findall("mesh/source"):
        if source.get("id") == named.get("source", "").removeprefix("#"):
            accessor = source.find("technique_common/accessor")
            stride = int(accessor.get("stride", "3")) if accessor is not None else 3
            numbers = np.array((source.findtext("float_array") or "").split(), dtype=np.float64)
            return numbers[: len(numbers) // stride * stride].reshape(-1, stride)[:, :3] if stride >= 3 else _none()
    return _none()


_READERS: Mapping[str, Callable[[bytes], Points]] = {".stl": _read_stl, ".dae": _read_collada, ".obj": _read_obj}
SUFFIXES = tuple(_READERS)
