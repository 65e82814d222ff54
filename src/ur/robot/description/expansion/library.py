"""The xacro of this computer: a library, which can be confined, or a program. None is taken from around a file."""

from __future__ import annotations

import os
import sysconfig
from collections.abc import Mapping
from pathlib import Path

from ur.robot.description.surroundings import Surroundings, is_safe_program


def find_library(made: Path, around: Surroundings) -> str | None:
    """The folder to import xacro from: "" for our own environment, or that of the package which `ur get` has made.

    `made` is the folder of the packages that `ur get` makes. None where there is none.
    """
    if find_own() is not None:
        return ""
    library = made / "xacro" / "lib"
    return str(library) if (library / "xacro/__init__.py").is_file() and not around.holds(library) else None


def find_own() -> Path | None:
    """The folder of xacro in our own environment, if it is there."""
    folders = [Path(sysconfig.get_path(kind), "xacro") for kind in ("purelib", "platlib")]
    return next((folder for folder in folders if (folder / "__init__.py").is_file()), None)


def find_program(environment: Mapping[str, str], around: Surroundings) -> tuple[str | None, tuple[str, ...]]:
    """The first program xacro on PATH that may be run, and those before it that may not."""
    refused: list[str] = []
    for folder in environment.get("PATH", "").split(os.pathsep):
        program = os.path.join(folder, "xacro")  # noqa: PTH118 - a relative one stays so
        if not os.path.isfile(program) or not os.access(program, os.X_OK):  # noqa: PTH113
            continue
        if (
            Path(folder).is_absolute()
            and not around.holds(program)
            and not around.holds(folder)
            and is_safe_program(program)
        ):
            return program, tuple(refused)
        refused.append(program)
    return None, tuple(refused)


def clean_path(value: str, around: Surroundings) -> str:
    """The folders of a variable such as PATH that are absolute and not around the description."""
    folders = [each for each in value.split(os.pathsep) if os.path.isabs(each) and not around.holds(each)]  # noqa: PTH117
    return os.pathsep.join(folders)
