"""The arguments of a program's launch file: read for its help page, and checked before the program starts."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ur.request.launch_request import LaunchFiles
from ur.request.programs import Program, find_launch_file
from ur.source.arguments import Argument
from ur.source.diagnostic import UserError, error
from ur.source.suggest import did_you_mean

if TYPE_CHECKING:
    from ur.launchfile.query.arguments import ArgumentSpec


def check_arguments(program: Program, arguments: Sequence[Argument], environment: Mapping[str, str]) -> None:
    """Raise UserError for an argument that a program's launch file does not declare."""
    path = find_launch_file(program) if arguments else None
    if path is None:
        return  # the program reads its arguments itself
    from ur.launchfile.world.system import SystemWorld

    refuse_undeclared(program.name, arguments, LaunchFiles([str(path)], SystemWorld(environment)).declared)


def refuse_undeclared(program: str, arguments: Sequence[Argument], declared: Sequence[str]) -> None:
    """Raise UserError for an argument of a program that is not among the declared ones of its launch file."""
    for name in (each.name for each in arguments):
        if name not in declared and not name.startswith("_"):
            near = did_you_mean(name, declared)
            help_ = f"did you mean {near}:=...?" if near else f"'ur run {program} --help' describes its arguments"
            known = ", ".join(declared) or "no arguments"
            message = f"unknown argument {name!r} of program {program!r}, expected one of {known}"
            raise UserError(error(message, rule="unknown-argument", help=help_))


def read_program_arguments(path: Path, environment: Mapping[str, str]) -> tuple[ArgumentSpec, ...]:
    """Return the arguments of a launch file, with the defaults that follow from the selection. Raises UserError."""
    from ur.launchfile.query.arguments import ArgumentSpec, read_arguments
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import add_own_package, current_selection
    from ur.request.plan_files import selected_arguments, texts
    from ur.source.arguments import values_of

    files = LaunchFiles([str(path)], SystemWorld(add_own_package(environment)))
    given = selected_arguments(current_selection(environment), files.declared, (), local=True)
    values = values_of(given)
    required = [Argument(name, "...") for name in _list_required(files) if name not in values]
    found = read_arguments(str(path), texts([*given, *required]), files.world, files.parsed)
    return tuple(
        ArgumentSpec(each.name, values[each.name], each.doc, each.span) if values.get(each.name) else each
        for each in found
    )


def _list_required(files: LaunchFiles) -> Iterator[str]:
    launch = files.parse(files.paths[0]).launch
    for element in launch.elements if launch is not None else ():
        if element.name == "arg" and not {"default", "value"} & set(element.attributes):
            yield element.attributes.get("name", "")
