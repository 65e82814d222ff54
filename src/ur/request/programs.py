"""Programs that `ur run` starts: the executables `bin/ur_*` of the launch library and of every package on the path."""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ur.source.arguments import Argument
from ur.source.diagnostic import user_error
from ur.source.foreign.files import read_head, read_text
from ur.source.project import launch_library
from ur.source.suggest import did_you_mean

if TYPE_CHECKING:
    from ur.launchfile.query.arguments import ArgumentSpec
    from ur.request.launch_request import LaunchFiles

PACKAGE = launch_library()
"""The launch library, whose programs are found first."""

PREFIX = "ur_"
_HEAD = 30  # lines
_LARGEST = 1024 * 1024  # bytes of a script
_HERE = 'here="$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")"'
_ONLY_LAUNCH = r'exec "\$here/ur" launch ((?:[\w.:=/-]+ )+)"\$@"'  # texts: Tab needs neither
_LAUNCH = r"(?m)^[^#\n]*\blaunch\s+(\w+)\s+(\w+\.launch(?:\.xml)?)\b"


class Program(NamedTuple):
    """A program: its name without `ur_`, its path, its `##Summary:` (may be empty), and its package's name."""

    name: str
    path: Path
    summary: str
    package: str = ""

    @property
    def folder(self) -> Path:
        """The folder of its package."""
        return self.path.parent.parent


class ProgramIndex(NamedTuple):
    """The programs of every package, the launch library's first; `problem` is the reason for omitted packages."""

    programs: tuple[Program, ...] = ()
    problem: str = ""


def list_programs(folder: str | os.PathLike[str], package: str = "") -> tuple[Program, ...]:
    """Return every executable `ur_*` of a folder, sorted by name."""
    try:
        names = sorted(os.listdir(folder))  # noqa: PTH208 - Tab does this for each package
    except OSError:
        return ()
    return tuple(
        Program(name.removeprefix(PREFIX), path, read_summary(path), package)
        for name in names
        if name.startswith(PREFIX) and (path := Path(folder, name)).is_file() and os.access(path, os.X_OK)
    )


def index_programs(library: Path, environment: Mapping[str, str]) -> ProgramIndex:
    """Find the programs of the launch library, then those of the packages on ROS_PACKAGE_PATH by package name."""
    from ur.launchfile.world.packages import find_packages, package_paths

    own = list_programs(f"{library}/bin", library.name)
    try:
        packages = find_packages(package_paths(environment))
    except (OSError, ValueError) as problem:
        return ProgramIndex(own, str(problem))
    others = (
        program
        for name, folder in sorted(packages.items())
        if name != library.name and os.access(f"{folder}/bin", os.F_OK)
        for program in list_programs(f"{folder}/bin", name)
    )
    return ProgramIndex((*own, *others))


def find_program(library: Path, name: str, environment: Mapping[str, str]) -> Program:
    """Find a program by its name, with or without `ur_`, or by PACKAGE/NAME.

    Raises UserError if no package has such a program, or several have.
    """
    index = index_programs(library, environment)
    path = find_unlisted(name)
    if path is not None and not any(each.name == path.name.removeprefix(PREFIX) for each in index.programs):
        package = path.parent.parent
        raise user_error(
            f"unknown program {name!r}: package {package.name!r} is not on ROS_PACKAGE_PATH",
            rule="unknown-program",
            help=f'export ROS_PACKAGE_PATH="{package.parent}:$ROS_PACKAGE_PATH"',
            subject=name,
        )
    return choose_program(index.programs, name, index.problem)


def find_unlisted(name: str) -> Path | None:
    """Find the program of this name in the package around the working folder, even if ROS does not find it."""
    bare = name.rpartition("/")[2].removeprefix(PREFIX)
    try:
        start = Path.cwd()
    except OSError:
        return None
    package = next((each for each in (start, *start.parents) if (each / "package.xml").is_file()), None)
    path = package / "bin" / (PREFIX + bare) if package is not None and bare else None
    return path if path is not None and path.is_file() and os.access(path, os.X_OK) else None


def choose_program(programs: Sequence[Program], name: str, problem: str = "") -> Program:
    """Return the program with a name. Raises UserError with the nearest name."""
    package, slash, last = name.rpartition("/")
    bare = last.removeprefix(PREFIX)
    found = [each for each in programs if each.name == bare and (not slash or each.package == package)]
    if len(found) == 1:
        return found[0]
    if found:
        names = " and ".join(each.package for each in found)
        raise user_error(
            f"program {name!r} is in {names}, expected PACKAGE/PROGRAM",
            rule="ambiguous-program",
            help=" or ".join(f"ur run {each.package}/{each.name}" for each in found),
            subject=name,
        )
    import shlex  # which Tab does without

    if last.endswith((".launch", ".launch.xml", ".launch.py", ".launch.yaml", ".test")):
        raise user_error(
            f"{name!r} is the name of a launch file, expected the name of a program",
            rule="unknown-program",
            help=f"start a launch file: ur launch {shlex.quote(name)}; 'ur list' lists the programs",
            subject=name,
        )
    near = did_you_mean(bare, {each.name for each in programs})
    help_ = f"did you mean 'ur run {near}'?" if near else "'ur list' describes each"
    if problem:
        help_ = f"packages were not searched ({problem}); {help_}"
    raise user_error(
        f"unknown program {name!r}, expected one of {_describe(programs) or '(none)'}",
        rule="unknown-program",
        help=help_,
        subject=name,
    )


def _describe(programs: Iterable[Program]) -> str:
    return ", ".join(dict.fromkeys(each.name for each in programs))


def read_summary(path: Path) -> str:
    """Read the text after `##Summary:` in a program's head; empty without one."""
    try:
        lines = read_head_lines(path)
    except OSError:
        return ""
    return next((each.removeprefix("##Summary:").strip() for each in lines if each.startswith("##Summary:")), "")


def read_head_lines(path: Path) -> list[str]:
    """Return the lines of a program's head, which describe it. Raises OSError."""
    return read_head(path).split("\n")[:_HEAD]


def read_launch_argv(program: Program) -> list[str] | None:
    """Return the arguments of `ur launch` in a program that only does `exec "$here/ur" launch ... "$@"`; else None.

    `$here` is the folder of the program, so this is the same `ur` only for the launch library's own programs.
    """
    try:
        lines = read_text(program.path, _LARGEST).splitlines()
    except OSError:
        return None
    code = [line for line in lines if line.strip() and not line.startswith("#")]
    found = re.fullmatch(_ONLY_LAUNCH, code[1]) if len(code) == 2 and code[0] == _HERE else None
    return found[1].split() if found else None


def find_launch_file(program: Program) -> Path | None:
    """Return the launch file of its own package that a program starts, or None."""
    try:
        text = read_text(program.path, _LARGEST)
    except OSError:
        return None
    package = program.folder
    for owner, name in re.findall(_LAUNCH, text):
        if owner in (program.package, package.name):
            paths = (package / name.partition(".")[0] / "launch" / name, package / "launch" / name, package / name)
            return next((path for path in paths if path.is_file()), None)
    return None


def check_arguments(program: Program, arguments: Sequence[Argument], environment: Mapping[str, str]) -> None:
    """Raise UserError for an argument that a program's launch file does not declare."""
    path = find_launch_file(program) if arguments else None
    if path is None:
        return  # the program reads its arguments itself
    from ur.launchfile.world.system import SystemWorld
    from ur.request.launch_request import LaunchFiles

    refuse_undeclared(program.name, arguments, LaunchFiles([str(path)], SystemWorld(environment)).declared)


def refuse_undeclared(program: str, arguments: Sequence[Argument], declared: Sequence[str]) -> None:
    """Raise UserError for an argument of a program that is not among the declared ones of its launch file."""
    for name in (each.name for each in arguments):
        if name not in declared and not name.startswith("_"):
            near = did_you_mean(name, declared)
            help_ = f"did you mean {near}:=...?" if near else f"'ur run {program} --help' describes its arguments"
            known = ", ".join(declared) or "no arguments"
            message = f"unknown argument {name!r} of program {program!r}, expected one of {known}"
            raise user_error(message, rule="unknown-argument", help=help_)


def read_program_arguments(path: Path, environment: Mapping[str, str]) -> tuple[ArgumentSpec, ...]:
    """Return the arguments of a launch file, with the defaults that follow from the selection. Raises UserError."""
    from ur.launchfile.query.arguments import ArgumentSpec, read_arguments
    from ur.launchfile.world.system import SystemWorld
    from ur.request.environment import add_own_package, current_selection
    from ur.request.launch_request import LaunchFiles
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
