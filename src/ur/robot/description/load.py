"""From the file of a description to a Description: expanded, parsed, and with the sizes of its meshes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ur.robot.description.model import Description
from ur.robot.description.parse import parse_urdf
from ur.robot.description.xacro import read_description


@dataclass(frozen=True, slots=True)
class Loaded:
    """A description, and the packages that its xacro file includes files from and that are not here."""

    description: Description
    missing: tuple[str, ...] = ()


def load_description(
    path: Path,
    environment: Mapping[str, str],
    packages: Callable[[], Mapping[str, str]],
    arguments: Sequence[str] = (),
) -> Loaded:
    """Read a URDF or xacro file, and its meshes. Raises UserError.

    `packages` finds the folders of packages by name; it is called at most once. `arguments` are those of xacro.
    """
    from ur.robot.description.meshes import measure_meshes  # numpy

    find_packages = cache(packages)
    expanded = read_description(path, environment, find_packages, arguments)
    description = parse_urdf(expanded.text, str(path))
    return Loaded(measure_meshes(description, path, find_packages), expanded.missing)
