"""Robots among the URDF and xacro files of a folder."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from ur.request.environment import PACKAGE
from ur.robot.base import list_bases
from ur.robot.description.drive import find_drive
from ur.robot.description.urdf_parts import Description
from ur.source.diagnostic import UserError
from ur.tools.new.description import load_file, look_around

_ROBOT = re.compile(r"<robot[\s>]")
_INCLUDE = re.compile(r"<(?:xacro:)?include\s[^>]*?filename\s*=\s*[\"']([^\"']+)[\"']")
_SUFFIXES = (".urdf.xacro", ".xacro", ".urdf")


@dataclass(frozen=True, slots=True)
class Robot:
    """A file that describes a robot; `description` is None, with the reason in `problem`, where it cannot be read."""

    name: str
    path: Path
    description: Description | None = None
    problem: str = ""


def find_robots(folder: Path) -> tuple[Robot, ...]:
    """The robots of a folder: each file directly in it, and of each checkout the files that no other one includes.

    Of a checkout, parts without wheels are left out; where nothing else is there, its first file is a robot, too.
    """
    robots: list[Robot] = []
    for child in sorted(folder.iterdir()):
        if child.is_dir() and child.name[0] != ".":
            robots += _of_checkout(child)
        elif child.is_file() and _is_description(child):
            robots.append(_read(child))
    return tuple(_with_own_names(robots, folder))


def list_roots(folder: Path) -> tuple[Path, ...]:
    """The descriptions below a folder that no other one includes; where several have one name, all are kept."""
    every = [path for suffix in ("urdf", "xacro") for path in folder.rglob(f"*.{suffix}") if path.is_file()]
    files = sorted(path for path in every if _is_description(path))
    included = {name for path in files for name in _included(path)}
    return tuple(path for path in files if _short(path.as_posix()) not in included)


def _of_checkout(folder: Path) -> Iterable[Robot]:
    found = [_read(path) for path in list_roots(folder)]
    driven = [robot for robot in found if robot.description and _drives(robot.description)]
    return driven or found[:1]


def _drives(description: Description) -> bool:
    return bool(find_drive(description).wheels)


def _is_description(path: Path) -> bool:
    return path.suffix in (".urdf", ".xacro") and _ROBOT.search(path.read_text(errors="replace")) is not None


def _included(path: Path) -> Iterator[str]:
    """The last two parts of the paths that a file includes, where they are written out; else the last one."""
    for name in _INCLUDE.findall(path.read_text(errors="replace")):
        yield _short(f"{path.parent.as_posix()}/{name}" if "/" not in name else name)


def _short(path: str) -> str:
    return "/".join(path.split("/")[-2:])


def _read(path: Path) -> Robot:
    try:
        return Robot("", path, load_file(path, look_around(path)).description)
    except UserError as problem:
        return Robot("", path, None, problem.diagnostics[0].message)


def _with_own_names(robots: Iterable[Robot], folder: Path) -> Iterator[Robot]:
    """Names that a base may have, each once: of the file, and of its checkout where two files have the same."""
    taken = set(list_bases(PACKAGE))
    for robot in robots:
        file = next(robot.path.name.removesuffix(end) for end in _SUFFIXES if robot.path.name.endswith(end))
        name = _base_name(file)
        if name in taken:
            name = _base_name(f"{robot.path.relative_to(folder).parts[0]}_{file}")
        number = 2
        while name in taken:
            name, number = f"{_base_name(file)}_{number}", number + 1
        taken.add(name)
        yield Robot(name, robot.path, robot.description, robot.problem)


def _base_name(text: str) -> str:
    name = re.sub(r"\W+", "_", text.lower(), flags=re.ASCII).strip("_")
    return name if name[:1].isalpha() else f"robot_{name}"
