"""Programs for the page: their list, their start, and the content of their launch files, by commands of `ur`."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import TypeVar

from ur.source.foreign.json_values import BadJsonError, read_json
from ur.source.printable import printable_lines
from ur.web.runs.watcher import CommandQueue, EndedCommand
from ur.web.wire.run_requests import StartProgram

_FRESH = 20.0  # s for which a list is considered current
_READING = 60.0  # time limit (s) of a command that only reads files
_STARTING = 120.0
_DIAGNOSING = 120.0


_LONGEST = 32 << 20  # characters of a command's output
Kind = TypeVar("Kind")


@dataclass(frozen=True, slots=True)
class ListedValue:
    """A permitted value of an argument."""

    text: str
    help: str


@dataclass(frozen=True, slots=True)
class ListedArgument:
    """An argument; one without default is required."""

    name: str
    doc: str
    default: str | None
    values: tuple[ListedValue, ...]


@dataclass(frozen=True, slots=True)
class ListedProgram:
    """A program as `ur list --json` describes it."""

    name: str
    package: str
    summary: str
    launch_file: str
    lack: str
    problem: str
    arguments: tuple[ListedArgument, ...]


class ProgramsError(Exception):
    """A command failed; the text is the reason, for users."""


class Programs:
    """Answers questions about programs. Each method raises ProgramsError."""

    def __init__(self, commands: CommandQueue) -> None:
        self._commands = commands
        self._listed: tuple[float, list[ListedProgram]] | None = None
        self._finding: tuple[float, dict[str, object]] | None = None

    async def list_all(self) -> list[dict[str, object]]:
        """List all programs with their arguments, as `ur list --json` does, without paths."""
        return [
            {name: value for name, value in asdict(each).items() if name != "launch_file"}
            | {"file": bool(each.launch_file)}
            for each in await self._read_list()
        ]

    async def start(self, request: StartProgram) -> str:
        """Start a program that continues without this server; return the id of its run."""
        program = await self._find(request.program)
        arguments = _check_arguments(program, request.arguments)
        done = await self._commands.run("run", program.name, "--detach", "--no-terminal", *arguments, limit=_STARTING)
        run = done.out.strip().rpartition("\n")[2]
        if done.code != 0 or not run:
            raise ProgramsError(explain_failure(done, f"program {program.name} did not start"))
        return run

    async def draw(self, program: str, arguments: Mapping[str, str]) -> str:
        """Draw the includes and nodes of a program's launch file, as SVG."""
        found = await self._find(program)
        done = await self._commands.run(
            "graph", *_address(found), *_check_arguments(found, arguments), "--as", "svg", limit=_READING
        )
        if not done.out.startswith("<svg"):
            raise ProgramsError(explain_failure(done, "the launch file cannot be drawn"))
        return done.out

    async def list_nodes(self, program: str, arguments: Mapping[str, str]) -> list[str]:
        """List the nodes that a program starts."""
        found = await self._find(program)
        assignments = _check_arguments(found, arguments)
        done = await self._commands.run("launch", *_address(found), *assignments, "--nodes", limit=_READING)
        if done.code != 0:
            raise ProgramsError(explain_failure(done, "the launch file cannot be read"))
        return [line for line in done.out.splitlines() if line.startswith("/")]

    async def explain(self, program: str, arguments: Mapping[str, str], node: str) -> str:
        """Explain why the launch file of a program starts a node, as lines of text."""
        found = await self._find(program)
        assignments = _check_arguments(found, arguments)
        done = await self._commands.run("explain", *_address(found), *assignments, node, limit=_READING)
        if done.code != 0:
            raise ProgramsError(explain_failure(done, f"{node} cannot be explained"))
        return printable_lines(done.out)

    async def diagnose(self) -> dict[str, object]:
        """Return the doctor's findings about this computer and the selected robot; nothing is changed."""
        if self._finding is not None and time.monotonic() - self._finding[0] < _FRESH:
            return self._finding[1]
        done = await self._commands.run("doctor", "--json", limit=_DIAGNOSING)
        found = parse_output(done, dict[str, object], "the doctor found out nothing")
        self._finding = (time.monotonic(), found)
        return found

    async def _read_list(self) -> list[ListedProgram]:
        if self._listed is None or time.monotonic() - self._listed[0] > _FRESH:
            done = await self._commands.run("list", "--json", limit=_READING)
            programs = parse_output(done, list[ListedProgram], "the programs cannot be listed")
            self._listed = (time.monotonic(), programs)
        return self._listed[1]

    async def _find(self, name: str) -> ListedProgram:
        for program in await self._read_list():
            if program.name == name:
                return program
        raise ProgramsError(f"unknown program {name!r}, expected one of the list")


def _address(program: ListedProgram) -> Sequence[str]:
    if not program.launch_file:
        raise ProgramsError(f"program {program.name} has no launch file")
    return (program.launch_file,)


def _check_arguments(program: ListedProgram, given: Mapping[str, str]) -> list[str]:
    """Return arguments in the form `NAME:=VALUE`. Raises ProgramsError for an unknown argument, or a missing one."""
    known = {each.name: each for each in program.arguments}
    unknown = [name for name in given if name not in known]
    if unknown:
        raise ProgramsError(f"unknown argument {unknown[0]!r} of program {program.name}")
    missing = [name for name, each in known.items() if each.default is None and not given.get(name)]
    if missing:
        raise ProgramsError(f"argument {missing[0]!r} is missing, expected a value")
    return [f"{name}:={value}" for name, value in given.items()]


def parse_output(done: EndedCommand, kind: type[Kind], otherwise: str) -> Kind:
    """Parse the JSON output of a command. Raises ProgramsError."""
    try:
        return read_json(done.out, kind, _LONGEST)
    except BadJsonError:
        raise ProgramsError(explain_failure(done, otherwise)) from None


def explain_failure(done: EndedCommand, otherwise: str) -> str:
    """Return the reason of a failure for users: the first error of a command with its help, or `otherwise`."""
    if done.late:
        return f"{otherwise}: it took too long"
    lines = printable_lines(done.err).splitlines()
    first = next((index for index, line in enumerate(lines) if "error: " in line), None)
    if first is None:
        return "\n".join([otherwise, *lines[-5:]])
    return "\n".join(lines[first : first + 6])
