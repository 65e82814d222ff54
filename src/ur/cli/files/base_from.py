"""`ur new base --from`: questions about properties that a URDF or xacro file does not define."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from ur.source.diagnostic import UserError, error
from ur.tools.new import description as files

if TYPE_CHECKING:
    from ur.robot.description.reading import DescriptionReading


def describe_base(
    source: Path, summary: str | None, figures: Mapping[str, float | None], arguments: Sequence[str], *,
    lidar: bool | None, raspicam: bool,
) -> str:  # fmt: skip
    """Return the text of a base.yaml for a description. Raises UserError.

    Prints the properties that were read; asks once for the others. `lidar` tells whether the robot has one; None if the
    file defines it. `arguments` are those of a xacro file.
    """
    from ur.robot.description.base_text import write_base_file
    from ur.robot.description.reading import read_base_figures

    if raspicam:
        message = "--raspicam has no effect with --from, which reads the camera from the file"
        raise UserError(error(message, rule="bad-value", help="add it to the base.yaml that is written"))
    given = {key: files.check_measured(key, value) for key, value in figures.items() if value is not None}
    files.check_arguments(source, arguments)
    around = files.look_around(source)
    loaded = files.load_file(source, around, arguments, consent=_ask_to_run)
    description = loaded.description
    reading = read_base_figures(description, given, lidar=lidar)
    click.echo(files.describe_reading(reading), err=True, nl=False)
    for note in files.describe_left_out(loaded, around):
        click.echo(note, err=True)
    if lidar is None and not reading.has_lidar:
        lidar = _ask_for_lidar(reading)
    while reading.open:
        given |= _ask_for(source, reading, lidar)
        reading = read_base_figures(description, given, lidar=lidar)
    if lidar is not None:
        reading = read_base_figures(description, given, lidar=lidar)
    return write_base_file(reading, summary or f"Robot {reading.name or source.stem}.", source.name)


def _ask_for_lidar(reading: DescriptionReading) -> bool | None:
    """Ask the user about a lidar; None without a terminal, and then the robot has none."""
    while sys.stdin.isatty():
        question = "the file has no lidar, which navigation requires; add a typical one on top? [Y/n]"
        answer = click.prompt(question, default="y", show_default=False, type=str).strip().lower()
        if answer in ("y", "yes", "n", "no"):
            return answer[0] == "y"
        click.echo(f"error: '{answer}' is no answer, expected y or n", err=True)
    if not reading.open:
        click.echo("note: the file has no lidar, which navigation requires; --lidar adds a typical one", err=True)
    return None


def _ask_to_run(what: str) -> bool:
    """Ask whether Python code of a description may run with all rights; without a terminal the answer is no."""
    if not sys.stdin.isatty():
        return False
    click.echo(f"warning: {what}", err=True)
    answer = click.prompt("run it? [y/N]", default="n", show_default=False, type=str).strip().lower()
    return answer in ("y", "yes")


def _ask_for(source: Path, reading: DescriptionReading, lidar: bool | None) -> dict[str, float]:
    """Ask the user for the open properties; without a terminal one error names all of them."""
    if sys.stdin.isatty():
        return {key: _prompt(key) for key in reading.open}
    raise files.missing_figures(source, reading, lidar)


def _prompt(key: str) -> float:
    from ur.robot.description.reading import MEASURES, QUESTIONS

    least, most = QUESTIONS[key]
    click.echo(f"how to measure it: {MEASURES[key]}", err=True)
    while True:
        question = f"{files.FIGURES[key][0]} ({least:g} to {most:g})"
        answer = click.prompt(question, default=f"{files.usual_figure(key):g}", type=str)
        try:
            return files.check_measured(key, files.read_number(key, answer), asked=True)
        except UserError as problem:
            click.echo(f"error: {problem.diagnostics[0].message}", err=True)
