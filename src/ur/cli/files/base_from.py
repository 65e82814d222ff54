"""`ur new base --from`: a base from a URDF or xacro file, and `--workspace`, a folder of its own for a base."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.cli.files.new_parts import TargetPackage, find_target
from ur.cli.files.new_things import FIGURES
from ur.source.diagnostic import UserError, error, error_about
from ur.source.foreign.files import MAX_MANIFEST, read_file, refuse_file
from ur.source.read import read_source
from ur.source.suggest import did_you_mean
from ur.tools.new.parts import NewFile

if TYPE_CHECKING:
    from ur.robot.description.load import LoadedDescription
    from ur.robot.description.reading import DescriptionReading
    from ur.robot.description.surroundings import Surroundings


_EXPECTED = "a URDF or xacro file"


@dataclass(frozen=True, slots=True)
class BaseDestination:
    """The destination of a base: the folder of its files, and the package of the bases that it is like.

    In a workspace, `prefix` is before the path of each file, `url` is where RViz finds the files, and `marker` is what
    makes the folder one; all are empty in a package.
    """

    target: TargetPackage
    library: Path
    prefix: str = ""
    url: str = ""
    marker: tuple[NewFile, ...] = ()

    def place_files(self, files: Iterable[NewFile]) -> list[NewFile]:
        """Those files where they go, and the marker of a new workspace."""
        return [*self.marker, *(replace(file, path=f"{self.prefix}{file.path}") for file in files)]


def target_of(package: str | None, workspace: str | None) -> BaseDestination:
    """The destination that is asked for; without one the package around the current folder. Raises UserError."""
    from ur.request.environment import PACKAGE
    from ur.robot.base.search import MARKER

    if workspace is None:
        help_ = "add --workspace ~/FOLDER, or change to the folder of a package, or name one with --package"
        target = find_target(package, help_)
        return BaseDestination(target, target.folder)
    if package is not None:
        message = "--package and --workspace name two places for the base, expected one of them"
        raise UserError(error(message, rule="bad-value", help="leave one of them out"))
    root = Path(workspace).expanduser().resolve()
    prefix = f"share/{PACKAGE.name}/"
    marker = () if (root / MARKER).exists() else (NewFile(MARKER, ""),)
    return BaseDestination(TargetPackage(PACKAGE.name, root), PACKAGE, prefix, (root / prefix).as_uri(), marker)


def check_source(source: Path) -> None:
    """Raise UserError for a description that does not exist, before anything is asked."""
    if not source.exists():
        near = did_you_mean(source.name, (each.name for each in source.absolute().parent.glob("*")))
        help_ = f"did you mean '{near}'?" if near else "give the path of the robot's description"
        reason = "no such file or directory, expected a URDF or xacro file"
        raise UserError(error_about(source, reason, rule="unreadable-file", help=help_))


def next_step(place: BaseDestination, name: str) -> str:
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
    from ur.robot.description.reading import read_base_figures

    if raspicam:
        message = "--raspicam has no effect with --from, which reads the camera from the file"
        raise UserError(error(message, rule="bad-value", help="add it to the base.yaml that is written"))
    given = {key: _check(key, value) for key, value in figures.items() if value is not None}
    for each in arguments:
        if not re.match(r"\w+:=", each):
            message = f"unexpected argument '{each}', expected ARG:=VALUE for '{source.name}'"
            raise UserError(error(message, rule="bad-value", subject=each))
    around = look_around(source)
    loaded = load_file(source, around, arguments, consent=_ask_to_run)
    description = loaded.description
    reading = read_base_figures(description, given, lidar=lidar)
    click.echo(_describe(reading), err=True, nl=False)
    if loaded.missing:
        names = " ".join(loaded.missing)
        click.echo(f"note: left out, since their packages are not here: files of {names} (ur get {names})", err=True)
    if loaded.outside:
        names = ", ".join(loaded.outside[:5]) + (" ..." if len(loaded.outside) > 5 else "")
        click.echo(f"note: meshes outside of '{around.folder}' and of packages are not read: {names}", err=True)
    if lidar is None and not reading.has_lidar:
        lidar = _ask_for_lidar(reading)
    while reading.open:
        given |= _ask_for(source, reading, lidar)
        reading = read_base_figures(description, given, lidar=lidar)
    if lidar is not None:
        reading = read_base_figures(description, given, lidar=lidar)
    return write_base_file(reading, summary or f"Robot {reading.name or source.stem}.", source.name)


def _ask_for_lidar(reading: DescriptionReading) -> bool | None:
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


def _ask_to_run(what: str) -> bool:
    """Ask whether Python of a description may run with all rights; without a terminal the answer is no."""
    if not sys.stdin.isatty():
        return False
    click.echo(f"warning: {what}", err=True)
    answer = click.prompt("run it? [y/N]", default="n", show_default=False, type=str).strip().lower()
    return answer in ("y", "yes")


def look_around(source: Path) -> Surroundings:
    """The surroundings of the file of a description. Raises UserError where it is not there."""
    from ur.robot.description.surroundings import find_surroundings

    try:
        return find_surroundings(source, os.environ)
    except OSError as problem:
        read_source(source, expected=_EXPECTED)  # which names files beside it
        raise refuse_file(source, problem, _EXPECTED) from None


def load_file(
    source: Path, around: Surroundings, arguments: Sequence[str] = (), *, consent: Callable[[str], bool] | None = None
) -> LoadedDescription:
    """Read a description with the xacro and the packages of this computer. Raises UserError.

    `consent` is asked, with what would run, before a xacro runs that cannot be confined; without it none does.
    """
    from ur.request.environment import own_packages
    from ur.robot.description.expansion.xacro import ExpansionComputer
    from ur.robot.description.load import load_description

    made = Path(own_packages(os.environ))
    computer = ExpansionComputer(os.environ, lambda: list_packages(around), made, consent or (lambda _: False))
    return load_description(source, around, computer, arguments)


def list_packages(around: Surroundings) -> dict[str, str]:
    """The folders of packages by name: those of this computer, and before them the file's own and those beside it."""
    from ur.launchfile.world.packages import package_name_in
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import add_own_package

    world = SystemWorld(add_own_package(os.environ))
    found = {name: world.find_package(name) for name in world.package_names()}
    for folder in reversed(around.packages):
        try:
            manifest = folder / "package.xml"
            name = package_name_in(str(manifest), read_file(manifest, MAX_MANIFEST, inside=folder))
        except (OSError, ValueError):
            continue
        if name:
            found[name] = str(folder)
    return found


def _ask_for(source: Path, reading: DescriptionReading, lidar: bool | None) -> dict[str, float]:
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


def _describe(reading: DescriptionReading) -> str:
    rows = [
        f"read: {key.replace('_', ' ')} {figure.value:.4g} ({figure.source})"
        for key, figure in reading.figures.items()
        if key not in reading.open and figure.source not in ("given", "usual")
    ]
    rows += [f"read: {sensor.kind} {sensor.frame} ({sensor.source})" for sensor in reading.sensors]
    rows += [f"note: {note}" for note in reading.notes]
    return "".join(f"{row}\n" for row in rows)
