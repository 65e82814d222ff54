"""Loader of robot descriptions: expand xacro, parse the URDF, and measure the meshes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from ur.robot.description.expansion.xacro import ExpansionComputer, read_description
from ur.robot.description.parse import parse_urdf
from ur.robot.description.surroundings import Surroundings
from ur.robot.description.urdf_parts import Description


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
    from ur.robot.description.meshes import measure_meshes  # imports numpy

    computer = replace(computer, packages=cache(computer.packages))
    expanded = read_description(path, around, computer, arguments)
    description = parse_urdf(expanded.text, str(path))
    measured, outside = measure_meshes(description, around, computer.packages)
    return LoadedDescription(measured, expanded.missing, outside)
