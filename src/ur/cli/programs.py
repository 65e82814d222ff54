"""The programs that `ur run` knows: `ur_*` in the launch package's `bin`."""

from __future__ import annotations

import os
import re
from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

PREFIX = "ur_"
_LAUNCH = re.compile(r"^[^#\n]*\blaunch\s+(\w+)\s+(\w+\.launch(?:\.xml)?)\b", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Program:
    """A program: its name without `ur_`, where it is, and its `##Summary:` (may be empty)."""

    name: str
    path: Path
    summary: str


def list_programs(folder: Path) -> tuple[Program, ...]:
    """Every executable `ur_*` of a folder, sorted by name."""
    return tuple(
        Program(path.name.removeprefix(PREFIX), path, read_summary(path))
        for path in sorted(folder.glob(PREFIX + "*"))
        if path.is_file() and os.access(path, os.X_OK)
    )


def find_program(folder: Path, name: str) -> Program:
    """The program with this name, `ur_` in front or not. Raises UserError: did you mean."""
    bare = name.removeprefix(PREFIX)
    path = folder / (PREFIX + bare)
    if "/" not in bare and path.is_file() and os.access(path, os.X_OK):
        return Program(bare, path, read_summary(path))
    names = [program.name for program in list_programs(folder)]
    near = did_you_mean(bare, names)
    raise UserError(
        error(
            f"program {name!r} is not known, expected one of {', '.join(names) or '(none)'}",
            rule="unknown-program",
            help=f"did you mean 'ur run {near}'?" if near else "'ur list' says what each does",
        )
    )


def read_summary(path: Path) -> str:
    """The text after `##Summary:` in a program's head; empty when it has none."""
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            for line, _ in zip(file, range(30), strict=False):
                if line.startswith("##Summary:"):
                    return line.removeprefix("##Summary:").strip()
    except OSError:
        return ""
    return ""


def find_launch_file(program: Program, package: Path) -> Path | None:
    """The launch file of its own package that a program starts; None when it starts none."""
    try:
        text = program.path.read_text(encoding="utf-8", errors="replace")
    except OSError:
        return None
    for owner, name in _LAUNCH.findall(text):
        if owner == package.name:
            path = package / name.partition(".")[0] / "launch" / name
            return path if path.is_file() else None
    return None
