"""`ur list`: list the programs, and mark those that the selected robot cannot run."""

import json
import os
import sys
from collections.abc import Callable, Mapping, Sequence

import click

from ur.request.environment import add_own_package, current_selection
from ur.request.programs import PACKAGE, Program, find_launch_file, index_programs, read_program_arguments
from ur.robot.base import Base, load_base
from ur.source.diagnostic import UserError
from ur.source.printable import printable
from ur.source.render import shows_colour

FIRST = ("keyboard_navigate", "make_map", "raspicam")
"""Programs of the library that most people want, in this order; the page has the same."""

_DIM, _PLAIN = "\x1b[2m", "\x1b[0m"


@click.command("list")
@click.option("--json", "as_json", is_flag=True, help="Print JSON, with the arguments of each program.")
def command(as_json: bool) -> int:
    """List the programs that `ur run` knows.

    They are the executables `bin/ur_*` of every package on ROS_PACKAGE_PATH. A line in brackets says what the base of
    the selected robot lacks for a program.
    """
    index = index_programs(PACKAGE, add_own_package(os.environ))
    if index.problem:
        sys.stderr.write(f"warning: only the programs of {PACKAGE.name} are listed: {printable(index.problem)}\n")
    from ur.request.bases.robot_facts import know_base
    from ur.robot.base.files import find_base_package

    try:
        selection = know_base(current_selection(os.environ), os.environ)
        package = find_base_package(PACKAGE, selection.base, os.environ)
        base = load_base(package, selection.base, selection.variant) if selection.base else None
    except UserError as problem:
        sys.stderr.write(f"what the base lacks is not known: {problem}\n")
        base = None
    if as_json:
        lack = (lambda program: _lack(program, base)) if base else (lambda _: "")
        described = describe_programs(index.programs, os.environ, lack)
        sys.stdout.write(json.dumps(described, indent=2) + "\n")
    else:
        sys.stdout.write(render_list(index.programs, base, colour=shows_colour(sys.stdout)))
    sys.stdout.flush()
    return 0


def render_list(programs: Sequence[Program], base: Base | None, *, colour: bool) -> str:
    """Return a line for each program: those of FIRST, then the others, by package if there are several packages."""
    width = max((len(program.name) for program in programs), default=0) + 2  # indented
    dim = (_DIM, _PLAIN) if colour else ("", "")

    def lines(group: Sequence[Program], indent: str = "") -> str:
        text = ""
        for program in group:
            lack = _lack(program, base) if base else ""
            line = f"{indent + program.name:<{width}}  {printable(program.summary)}".rstrip()
            text += line + (f"  {dim[0]}[{lack}]{dim[1]}" if lack else "") + "\n"
        return text

    own = {program.name: program for program in programs if program.package == PACKAGE.name}
    first = [own[name] for name in FIRST if name in own]
    others = [program for program in programs if program not in first]
    packages = list(dict.fromkeys(program.package for program in others))
    groups = [lines(first)] if first else []
    for package in packages:
        title = package if len(packages) > 1 else "other programs"
        groups.append(f"{title}:\n" + lines([each for each in others if each.package == package], "  "))
    return "\n".join(groups)


def _lack(program: Program, base: Base) -> str:
    from ur.launchfile.world.system import SystemWorld
    from ur.request.bases.base_argument import describe_lack, list_lacks, read_needs

    path = find_launch_file(program)
    lacks = list_lacks(base, read_needs(str(path), SystemWorld(os.environ))) if path else ()
    return describe_lack(base, lacks) if lacks else ""


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
