"""The request of a command line with launch files, made once, at the start of its verb."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ur.launchfile.address import resolve_addresses
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.world.protocol import World
from ur.request.misspelt import suggest_assignment
from ur.robot.selection import Selection
from ur.source.arguments import Argument, CommandLine, values_of
from ur.source.diagnostic import UserError, error

if TYPE_CHECKING:
    from ur.request.options import LaunchOptions

STANDARD_INPUT = "-"


class LaunchFiles:
    """The launch files of a request, in a world. Each file and include is read and parsed only once.

    `parsed` has the trees by the paths that name them; `load_plan` uses and extends it.
    """

    def __init__(self, paths: Sequence[str], world: World) -> None:
        self.paths = tuple(paths)
        self.world = world
        self.parsed: dict[str, LaunchFile] = {}
        self._declared: tuple[str, ...] | None = None

    def parse(self, path: str) -> LaunchFile:
        """Parse a file, unless it was parsed before. Raises OSError."""
        known = self.parsed.get(path)
        if known is None:
            known = self.parsed[path] = parse_launch_file(path, self.world.read_bytes(path))
        return known

    @property
    def declared(self) -> tuple[str, ...]:
        """Return the arguments that the files declare and that can be given, in order.

        Unreadable files declare none.
        """
        if self._declared is None:
            names: dict[str, None] = {}
            for path in self.paths:
                try:
                    parsed = self.parse(path)
                except OSError:
                    continue
                for element in parsed.launch.elements if parsed.launch is not None else ():
                    if element.name == "arg" and "value" not in element.attributes:
                        names[element.attributes.get("name", "")] = None
            self._declared = tuple(names)
        return self._declared


@dataclass(frozen=True, slots=True)
class LaunchRequest:
    """Launch files with their given arguments, the selected robot, and options.

    Without a `selection` the arguments are complete. `names` are the names of the command line as typed.
    """

    files: LaunchFiles
    arguments: tuple[Argument, ...] = ()
    selection: Selection | None = None
    given_options: LaunchOptions | None = None
    names: tuple[str, ...] = ()

    @property
    def options(self) -> LaunchOptions:
        """The given options, else the defaults."""
        if self.given_options is None:
            from ur.request.options import LaunchOptions  # questions need none, and its import takes 2 ms

            return LaunchOptions()
        return self.given_options

    @property
    def values(self) -> dict[str, str]:
        """Return the values of the arguments by name."""
        return values_of(self.arguments)

    @property
    def argv(self) -> tuple[str, ...]:
        """Return the names and arguments as a command line, without options."""
        return (*self.names, *map(str, self.arguments))

    def add_arguments(self, added: Iterable[Argument]) -> LaunchRequest:
        """Return a request with more arguments."""
        return replace(self, arguments=(*self.arguments, *added))


def make_request(
    line: CommandLine, world: World, selection: Selection | None = None, options: LaunchOptions | None = None
) -> LaunchRequest:
    """Make a request of `FILE` or `PACKAGE FILE`, and `[ARG:=VALUE]...`.

    Raises UserError for a missing file, or a name that is neither a file nor an argument.
    """
    files = LaunchFiles(resolve_addresses(line.names, world), world)
    refuse_stray_names(files)
    return LaunchRequest(files, line.arguments, selection, options, line.names)


def refuse_stray_names(files: LaunchFiles) -> None:
    """Raise UserError for a name after the launch file that is neither another file nor NAME:=VALUE."""
    for name in files.paths[1:]:
        if name == STANDARD_INPUT or files.world.is_file(name):
            continue
        declared = files.declared
        near = suggest_assignment(name, declared)
        known = f", expected NAME:=VALUE with NAME one of {', '.join(declared)}"
        if not declared:
            known = ": the launch file declares no arguments"
        raise UserError(
            error(
                f"{name!r} is not an argument{known}",
                rule="bad-argument",
                help=f"did you mean {near}?" if near else None if declared else f"leave {name} out",
                subject=name,
            )
        )
