"""Meshes of a description, measured: each becomes a shape, of the points of its hull."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import lru_cache
from itertools import product
from pathlib import Path
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from ur.robot.description.mesh_file import SUFFIXES, read_mesh
from ur.robot.description.model import Description, Link, Mesh, Shape
from ur.robot.description.pose import Vector

_TURNS = 32  # directions in each plane of two axes
_SMALLEST, _LARGEST = 0.001, 10.0  # m; a mesh of any other size is in other units
_NEAREST = 5  # folders above a description in which a package may lie that has no package.xml


def measure_meshes(description: Description, path: Path, packages: Callable[[], Mapping[str, str]]) -> Description:
    """The description with the meshes that can be read as shapes of their links; the others stay meshes.

    `path` is the file of the description. `packages` finds the folders of packages by name, if a mesh names one.
    """
    known: dict[str, str] = {}
    if any(mesh.file.startswith("package://") for link in description.links for mesh in link.meshes):
        known.update(packages())
    return replace(description, links=tuple(_measure(link, path, known) for link in description.links))


def _measure(link: Link, path: Path, packages: Mapping[str, str]) -> Link:
    shapes: dict[bool, list[Shape]] = {True: list(link.collision), False: list(link.visual)}
    left: list[Mesh] = []
    for mesh in link.meshes:
        file = _find(mesh.file, path, packages)
        points = _scale(_read_hull(file), mesh.scale) if file else ()
        size = max((max(each) - min(each) for each in zip(*points, strict=True)), default=0.0)
        if _SMALLEST <= size <= _LARGEST:
            shapes[mesh.collides].append(Shape("mesh", (), mesh.pose, points))
        else:
            left.append(mesh)
    return replace(link, collision=tuple(shapes[True]), visual=tuple(shapes[False]), meshes=tuple(left))


def _find(name: str, path: Path, packages: Mapping[str, str]) -> Path | None:
    """The file of `package://PACKAGE/...`, `file://...`, or a path from the folder of the description."""
    kind, found, rest = name.partition("://")
    if Path(name).suffix.lower() not in SUFFIXES or "\0" in name:
        return None
    if not found:
        return path.parent / name
    if kind == "file":
        return Path(unquote(rest.removeprefix("localhost")))
    package, _, inside = rest.partition("/")
    if kind != "package" or not package or package in (".", ".."):
        return None
    if package in packages:
        return Path(packages[package], inside)
    above = list(path.resolve().parents)[:_NEAREST]
    folders = [folder for parent in above for folder in (parent / package, parent) if folder.name == package]
    return next((folder / inside for folder in folders if (folder / inside).is_file()), None)


def _scale(points: tuple[Vector, ...], scale: Vector) -> tuple[Vector, ...]:
    return tuple((x * scale[0], y * scale[1], z * scale[2]) for x, y, z in points)


@lru_cache(maxsize=256)
def _read_hull(path: Path) -> tuple[Vector, ...]:
    """The outermost points of a mesh in many directions."""
    points = read_mesh(path)
    if not len(points):
        return ()
    outermost = sorted({int(np.argmax(points @ direction)) for direction in _directions()})
    return tuple((float(x), float(y), float(z)) for x, y, z in points[outermost])


def _directions() -> list[NDArray[np.float64]]:
    turns = [2.0 * math.pi * n / _TURNS for n in range(_TURNS)]
    level = [np.array([math.cos(turn), math.sin(turn), 0.0]) for turn in turns]
    slanted = [np.array(signs) for signs in product((-1.0, 1.0), repeat=3)]
    return [*(np.roll(each, shift) for each in level for shift in range(3)), *slanted]
