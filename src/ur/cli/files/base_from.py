"""`ur new base --from`: a base from a URDF or xacro file, and `--workspace`, a folder of its own for a base."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.cli.files.new_parts import Target, find_target
from ur.cli.files.new_things import FIGURES
from ur.new.model import NewFile
from ur.source.diagnostic import UserError, error

if TYPE_CHECKING:
    from ur.robot.description.reading import Reading


@dataclass(frozen=True, slots=True)
class Place:
    """The destination of a base: the folder of its files, and the package of the bases that it is like.

    In a workspace, `prefix` is before the path of each file, `url` is where RViz finds the files, and `marker` is what
    makes the folder one; all are empty in a package.
    """

    target: Target
    library: Path
    prefix: str = ""
    url: str = ""
    marker: tuple[NewFile, ...] = ()

    def place_files(self, files: Iterable[NewFile]) -> list[NewFile]:
        """Those files where they go, and the marker of a new workspace."""
        return [*self.marker, *(replace(file, path=f"{self.prefix}{file.path}") for file in files)]


def target_of(package: str | None, workspace: str | None) -> Place:
    """The destination that is asked for; without one the package around the current folder. Raises UserError."""
    from ur.request.environment import PACKAGE
    from ur.robot.base.search import MARKER

    if workspace is None:
        target = find_target(package)
        return Place(target, target.folder)
    if package is not None:
        message = "--package and --workspace name two places for the base, expected one of them"
        raise UserError(error(message, rule="bad-value", help="leave one of them out"))
    root = Path(workspace).expanduser().resolve()
    prefix = f"share/{PACKAGE.name}/"
    marker = () if (root / MARKER).exists() else (NewFile(MARKER, ""),)
    return Place(Target(PACKAGE.name, root), PACKAGE, prefix, (root / prefix).as_uri(), marker)


def next_step(place: Place, name: str) -> str:
    """The commands that use the new base."""
    if not place.prefix:
        return f"ur use sim:{name}"
    return f"export CMAKE_PREFIX_PATH={place.target.folder}:$CMAKE_PREFIX_PATH, then ur use sim:{name}"


def refuse_arguments(arguments: Sequence[str]) -> None:
    """Refuse arguments of a command without a file that could take them. Raises UserError."""
    if arguments:
        message = f"unexpected argument '{arguments[0]}', expected --from with the xacro file that takes it"
        raise UserError(error(message, rule="bad-value", help="leave it out, or add --from FILE"))


def describe_base(
    source: Path, summary: str | None, figures: Mapping[str, float | None], arguments: Sequence[str], *,
    lidar: bool | None, raspicam: bool,
) -> str:  # fmt: skip
    """The text of the base.yaml that follows from a description. Raises UserError.

    Prints what was read; asks once for everything that was not. `lidar` says whether it has one; None if the file does.
    `arguments` are those of a xacro file.
    """
    from ur.robot.description.base_text import write_base_file
    from ur.robot.description.load import load_description
    from ur.robot.description.reading import read_base_figures

    if raspicam:
        message = "--raspicam has no effect with --from, which reads the camera from the file"
        raise UserError(error(message, rule="bad-value", help="add it to the base.yaml that is written"))
    given = {key: _check(key, value) for key, value in figures.items() if value is not None}
    for each in arguments:
        if not re.match(r"\w+:=", each):
            message = f"unexpected argument '{each}', expected ARG:=VALUE for '{source.name}'"
            raise UserError(error(message, rule="bad-value", subject=each))
    loaded = load_description(source, os.environ, lambda: list_packages(source), arguments)
    description = loaded.description
    reading = read_base_figures(description, given, lidar=lidar)
    click.echo(_describe(reading), err=True, nl=False)
    if loaded.missing:
        names = " ".join(loaded.missing)
        click.echo(f"note: left out, since their packages are not here: files of {names} (ur get {names})", err=True)
    if lidar is None and not reading.has_lidar:
        lidar = _ask_for_lidar(reading)
    while reading.open:
        given |= _ask_for(source, reading, lidar)
        reading = read_base_figures(description, given, lidar=lidar)
    if lidar is not None:
        reading = read_base_figures(description, given, lidar=lidar)
    return write_base_file(reading, summary or f"Robot {reading.name or source.stem}.", source.name)


def _ask_for_lidar(reading: Reading) -> bool | None:
    """The answer of a person; None without a terminal, and then the robot has none."""
    while sys.stdin.isatty():
        question = "the file has no lidar, which the way to a goal needs: add a usual one on top? [Y/n]"
        answer = click.prompt(question, default="y", show_default=False, type=str).strip().lower()
        if answer in ("y", "yes", "n", "no"):
            return answer[0] == "y"
        click.echo(f"error: '{answer}' is no answer, expected y or n", err=True)
    if not reading.open:
        click.echo("note: the file has no lidar, which the way to a goal needs; --lidar adds a usual one", err=True)
    return None


def list_packages(source: Path) -> dict[str, str]:
    """The folders of packages by name: those of this computer, and before them the file's own and those beside it."""
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import add_own_package

    environment = add_own_package(os.environ)
    own = next((folder for folder in source.resolve().parents if (folder / "package.xml").is_file()), None)
    if own is not None:
        beside = sorted(path.parent for path in own.parent.glob("*/package.xml") if path.parent != own)
        folders = [*map(str, (own, *beside)), environment.get("ROS_PACKAGE_PATH", "")]
        environment = {**environment, "ROS_PACKAGE_PATH": os.pathsep.join(filter(None, folders))}
    world = SystemWorld(environment)
    return {name: world.find_package(name) for name in world.package_names()}


def _ask_for(source: Path, reading: Reading, lidar: bool | None) -> dict[str, float]:
    """The open figures, from a person; without a terminal all of them are named in one error."""
    if sys.stdin.isatty():
        return {key: _prompt(key) for key in reading.open}
    asks = lidar is None and not reading.has_lidar
    names = ", ".join([*(key.replace("_", " ") for key in reading.open), *(["a lidar"] if asks else [])])
    options = " ".join(f"--{key.replace('_', '-')} {_ordinary(key):g}" for key in reading.open)
    options += " --lidar (or --no-lidar)" if asks else ""
    message = f"cannot read from '{source}': {names}"
    raise UserError(error(message, rule="not-given", help=f"add, with your robot's figures: {options}"))


def _prompt(key: str) -> float:
    from ur.robot.description.reading import MEASURES, QUESTIONS

    least, most = QUESTIONS[key]
    click.echo(f"how to measure it: {MEASURES[key]}", err=True)
    while True:
        answer = click.prompt(f"{FIGURES[key][0]} ({least:g} to {most:g})", default=f"{_ordinary(key):g}", type=str)
        try:
            return _check(key, _read_answer(key, answer))
        except UserError as problem:
            click.echo(f"error: {problem.diagnostics[0].message}", err=True)


def _read_answer(key: str, answer: str) -> float:
    try:
        return float(answer)
    except ValueError:
        pass
    point = f", as {answer.replace(',', '.')}" if re.fullmatch(r"\d*,\d+", answer.strip()) else " without a unit"
    message = f"'{answer}' is no number, expected one{point}: {FIGURES[key][0][0].lower()}{FIGURES[key][0][1:]}"
    raise UserError(error(message, rule="bad-value"))


def _ordinary(key: str) -> float:
    """The suggested value."""
    from ur.robot.description.reading import QUESTIONS

    return min(FIGURES[key][1], QUESTIONS[key][1])


def _check(key: str, value: float) -> float:
    from ur.robot.description.reading import QUESTIONS

    least, most = QUESTIONS[key]
    if least <= value <= most:  # not so for NaN
        return value
    option = f"--{key.replace('_', '-')}"
    why = ", so that the robot stops within 0.3 s" if key.endswith("velocity") else ""
    message = f"invalid {option} '{value:g}', expected a number from {least:g} to {most:g}{why}"
    raise UserError(error(message, rule="bad-value", help=f"give {option}: {FIGURES[key][0]}"))


def _describe(reading: Reading) -> str:
    rows = [
        f"read: {key.replace('_', ' ')} {figure.value:.4g} ({figure.source})"
        for key, figure in reading.figures.items()
        if key not in reading.open and figure.source not in ("given", "usual")
    ]
    rows += [f"read: {sensor.kind} {sensor.frame} ({sensor.source})" for sensor in reading.sensors]
    rows += [f"note: {note}" for note in reading.notes]
    return "".join(f"{row}\n" for row in rows)
