"""Meshes of a description as triangles, and a description with them: read, expanded and surrounded by its files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from urllib.parse import unquote

from ur.robot.description.expansion.xacro import ExpansionComputer, read_description
from ur.robot.description.mesh_file import SUFFIXES, read_mesh
from ur.robot.description.parse import parse_urdf
from ur.robot.description.pose import Vector
from ur.robot.description.surroundings import Surroundings
from ur.robot.description.urdf_parts import Description, Link, Mesh, Shape

_SMALLEST, _LARGEST = 0.001, 10.0  # m; a mesh of any other size uses other units
_MOST_BYTES = 400_000_000  # of all mesh files of a description


def measure_meshes(
    description: Description, around: Surroundings, packages: Callable[[], Mapping[str, str]]
) -> tuple[Description, tuple[str, ...]]:
    """Replace each readable mesh by a shape of its link; other meshes stay meshes.

    The second value has the names of meshes that are not read since they lie outside of the description and of all
    packages. `packages` finds the folders of packages by name, and is called only if a mesh names one.
    """
    known: dict[str, str] = {}
    if any(mesh.file.startswith("package://") for link in description.links for mesh in link.meshes):
        known.update(packages())
    reader = _Reader(around, known)
    links = tuple(_measure(link, reader) for link in description.links)
    return replace(description, links=links), tuple(reader.outside)


def _measure(link: Link, reader: _Reader) -> Link:
    shapes: dict[bool, list[Shape]] = {True: list(link.collision), False: list(link.visual)}
    left: list[Mesh] = []
    for mesh in link.meshes:
        points = _scale(reader.read(mesh.file), mesh.scale)
        size = max((max(each) - min(each) for each in zip(*points, strict=True)), default=0.0)
        if _SMALLEST <= size <= _LARGEST:
            shapes[mesh.collides].append(Shape("mesh", (), mesh.pose, points))
        else:
            left.append(mesh)
    return replace(link, collision=tuple(shapes[True]), visual=tuple(shapes[False]), meshes=tuple(left))


class _Reader:
    """Reader of one description's meshes: it reads each file once, and a limited number of bytes in total."""

    def __init__(self, around: Surroundings, packages: Mapping[str, str]) -> None:
        self.outside: dict[str, None] = {}
        self._around = around
        self._packages = packages
        self._left = _MOST_BYTES
        self._read: dict[Path, tuple[Vector, ...]] = {}

    def read(self, name: str) -> tuple[Vector, ...]:
        """Return the outermost points of the mesh with this name in the description; () if it cannot be read."""
        path = self._find(name)
        if path is None:
            return ()
        file = self._around.find_readable(path, self._packages.values())
        if file is None:
            if path.is_file():
                self.outside[name] = None
            return ()
        if file not in self._read:
            self._read[file] = self._measure(file)
        return self._read[file]

    def _measure(self, file: Path) -> tuple[Vector, ...]:
        try:
            self._left -= file.stat().st_size
        except OSError:
            return ()
        if self._left < 0:
            return ()
        return tuple((float(x), float(y), float(z)) for x, y, z in read_mesh(file))

    def _find(self, name: str) -> Path | None:
        """Find the file of `package://PACKAGE/...`, `file://...`, or a path relative to the description's folder."""
        kind, found, rest = name.partition("://")
        if Path(name).suffix.lower() not in SUFFIXES or "\0" in name:
            return None
        if not found:
            return self._around.file.parent / name
        if kind == "file":
            return Path(unquote(rest.removeprefix("localhost")))
        package, _, inside = rest.partition("/")
        if kind != "package" or not package or package in (".", ".."):
            return None
        if package in self._packages:
            return Path(self._packages[package], inside)
        above = [each for each in self._around.file.parents if each.is_relative_to(self._around.folder)]
        folders = [folder for parent in above for folder in (parent / package, parent) if folder.name == package]
        return next((folder / inside for folder in folders if (folder / inside).is_file()), None)


def _scale(points: tuple[Vector, ...], scale: Vector) -> tuple[Vector, ...]:
    return tuple((x * scale[0], y * scale[1], z * scale[2]) for x, y, z in points)


@dataclass(frozen=True, slots=True)
class LoadedDescription:
    """A description, the packages that its xacro file includes but that are not installed, and unread meshes.

    `outside` are the meshes that are not read since they lie outside of the description and of all packages.
    """

    description: Description
    missing: tuple[str, ...] = ()
    outside: tuple[str, ...] = ()


def load_description(
    path: Path, around: Surroundings, computer: ExpansionComputer, arguments: Sequence[str] = ()
) -> LoadedDescription:
    """Read a URDF or xacro file, and its meshes. Raises UserError.

    `around` are the surroundings of the file; `arguments` are those of xacro. The packages of `computer` are found at
    most once.
    """
    computer = replace(computer, packages=cache(computer.packages))
    expanded = read_description(path, around, computer, arguments)
    description = parse_urdf(expanded.text, str(path))
    measured, outside = measure_meshes(description, around, computer.packages)
    return LoadedDescription(measured, expanded.missing, outside)
