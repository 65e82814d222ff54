"""Programs as JSON: their description, the robot's missing features, and the arguments of their launch files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from ur.request.programs import Program, find_launch_file
from ur.source.diagnostic import UserError


def describe_programs(
    programs: Sequence[Program], environment: Mapping[str, str], lack: Callable[[Program], str]
) -> list[dict[str, object]]:
    """Describe programs as objects for `ur list --json`.

    `name` is the argument for `ur run`, `launch_file` its path or "" for a program that reads its arguments itself,
    `lack` the features that the selected robot lacks, `problem` the reason why its arguments are unknown. Each of
    `arguments` has `name`, `doc`, `default` (null: required) and the known `values`, each with `text` and `help`.
    """
    names = [program.name for program in programs]
    return [_describe(program, names.count(program.name) > 1, environment, lack(program)) for program in programs]


def _describe(program: Program, ambiguous: bool, environment: Mapping[str, str], lack: str) -> dict[str, object]:
    from ur.request.program_arguments import read_program_arguments

    path = find_launch_file(program)
    problem = ""
    arguments: list[dict[str, object]] = []
    try:
        for each in read_program_arguments(path, environment) if path is not None else ():
            values = _list_values(each.name, each.default, environment)
            arguments.append({"name": each.name, "doc": each.doc, "default": each.default, "values": values})
    except UserError as found:
        problem = str(found)
    return {
        "name": f"{program.package}/{program.name}" if ambiguous else program.name,
        "package": program.package,
        "summary": program.summary,
        "launch_file": str(path or ""),
        "lack": lack,
        "problem": problem,
        "arguments": arguments,
    }


def _list_values(name: str, default: str | None, environment: Mapping[str, str]) -> list[dict[str, str]]:
    from ur.complete.names import list_values

    found = [{"text": each.text, "help": each.help} for each in list_values(name, {}, environment)]
    if not found and (default or "").lower() in ("true", "false"):
        return [{"text": "true", "help": ""}, {"text": "false", "help": ""}]
    return found
