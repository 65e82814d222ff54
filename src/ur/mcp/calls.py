"""The tools of the server: their names, what they do, and their arguments with limits."""

from dataclasses import dataclass
from typing import Annotated

import msgspec
from msgspec import Meta, field

from ur.mcp.grants import Speed
from ur.source.foreign.json_values import BadJsonError, PrintableValue, convert_json
from ur.source.printable import printable
from ur.source.suggest import did_you_mean

_Text = Annotated[str, Meta(max_length=300)]
_Word = Annotated[str, Meta(max_length=300, pattern="^[^-]")]
_NAME = "a name without a dash at its beginning, at most 300 characters"
_Name = Annotated[str, Meta(max_length=300, pattern="^[^-]", description=_NAME)]
_PATHS = "packages, files or folders: at most 20, none of which begins with a dash"
_Paths = Annotated[tuple[_Word, ...], Meta(max_length=20, description=_PATHS)]
_VALUES = "texts by the names of arguments of the launch file, at most 20"
_Values = Annotated[dict[_Text, _Text], Meta(max_length=20, description=_VALUES)]
_Metres = Annotated[float, Meta(ge=-1e5, le=1e5, description="metres in the frame of the map")]


class ToolArguments(PrintableValue, frozen=True):
    """Arguments of a tool."""


class NothingGiven(ToolArguments, frozen=True):
    """Nothing."""


class CommandGiven(ToolArguments, frozen=True, kw_only=True):
    """Arguments of a command of `ur`, in the order of its command line."""

    def words(self) -> list[str]:
        """The arguments as the command takes them."""
        words: list[str] = []
        for value in msgspec.structs.astuple(self):
            if isinstance(value, dict):
                value = [f"{name}:={each}" for name, each in value.items()]
            words += [value] if isinstance(value, str) else value
        return list(filter(None, words))


class PathsGiven(CommandGiven, frozen=True, kw_only=True):
    """Packages and files to check, with these values only where there are `arguments`."""

    paths: _Paths
    arguments: _Values = field(default_factory=dict)


class NameSought(CommandGiven, frozen=True, kw_only=True):
    """A node, topic, parameter, argument or file; `paths` are searched, this project without any."""

    name: _Name
    paths: _Paths = ()


class FileGiven(CommandGiven, frozen=True, kw_only=True):
    """A launch file of a package, or one below a workspace by its path, and its arguments."""

    package: _Name = ""
    file: _Name
    arguments: _Values = field(default_factory=dict)


class NameInFileGiven(FileGiven, frozen=True, kw_only=True):
    """A parameter, argument, remap or node of a launch file."""

    name: _Name


class PlaceGiven(ToolArguments, frozen=True):
    """A place of the map; the heading in degrees, to the left of the x axis."""

    x: _Metres
    y: _Metres
    heading: Annotated[float, Meta(ge=-360.0, le=360.0)] | None = None
    seconds: Annotated[float, Meta(gt=0.0, le=120.0)] = 60.0


class VelocityGiven(ToolArguments, frozen=True):
    """A velocity, m/s (negative: backward) and rad/s to the left, for so many seconds.

    `left` (m/s) is for a base that drives sideways.
    """

    speed: Annotated[float, Meta(ge=-2.0, le=2.0)]
    turn: Annotated[float, Meta(ge=-4.0, le=4.0)] = 0.0
    left: Annotated[float, Meta(ge=-2.0, le=2.0)] = 0.0
    seconds: Annotated[float, Meta(gt=0.0, le=5.0)] = 1.0


class TimeGiven(ToolArguments, frozen=True):
    """Seconds at most."""

    seconds: Annotated[float, Meta(gt=0.0, le=120.0)] = 60.0


class GrantAsked(ToolArguments, frozen=True):
    """For how long, how fast (m/s), and why."""

    minutes: Annotated[float, Meta(gt=0.0, le=1440.0)] = 30.0
    speed: Speed = 0.2
    reason: Annotated[str, Meta(max_length=200)] = ""


class ProgramGiven(ToolArguments, frozen=True):
    """A program of `ur list`, and arguments of its launch file."""

    name: Annotated[str, Meta(pattern=r"^[a-z][a-z0-9_]{0,40}$")]
    arguments: _Values = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class AssistantTool:
    """A tool; `verb` is the command of `ur` that it runs, () for none."""

    name: str
    text: str
    arguments: type[ToolArguments]
    verb: tuple[str, ...] = ()


EXAMPLES: dict[str, dict[str, object]] = {
    "check": {"paths": ["ubiquity_launches"], "arguments": {"robot_base": "magni"}},
    "explain": {"package": "ubiquity_launches", "file": "m_move_base.launch.xml", "name": "robot_base"},
    "find": {"name": "robot_base", "paths": ["ubiquity_launches"]},
    "graph": {"package": "ubiquity_launches", "file": "n_motor_node.launch.xml"},
}
"""The arguments of a call, by the names of tools."""

TOOLS = {
    each.name: each
    for each in (
        AssistantTool("look", "Look at the robot: pose, what is near, battery, goal, driver, grant.", NothingGiven),
        AssistantTool("list", "List the programs that can run on the robot.", NothingGiven, ("list",)),
        AssistantTool("check", "Check launch files, YAML files and packages; nothing is run.", PathsGiven, ("check",)),
        AssistantTool("explain", "Explain where a name in a launch file got its value.", NameInFileGiven, ("explain",)),
        AssistantTool("find", "Find where a name in launch files is defined and used.", NameSought, ("find",)),
        AssistantTool("graph", "Describe what a launch file includes and starts.", FileGiven, ("graph",)),
        AssistantTool("doctor", "Find what is wrong between this computer and the robot.", NothingGiven, ("doctor",)),
        AssistantTool("ask_to_drive", "Ask your user for a grant; it is given on a page or in a terminal.", GrantAsked),
        AssistantTool("go_to", "Drive to a place of the map, around obstacles, and wait for the end.", PlaceGiven),
        AssistantTool("drive", "Drive at a velocity for at most 5 s, then stop.", VelocityGiven),
        AssistantTool("explore", "Drive to where the map grows, and wait; call again until it is complete.", TimeGiven),
        AssistantTool("stop", "Stop what this assistant drives.", NothingGiven),
        AssistantTool("start_program", "Start a program, if the grant includes programs.", ProgramGiven),
        AssistantTool("end_program", "End a program that was started, if the grant includes programs.", ProgramGiven),
    )
}


def schema_of(tool: AssistantTool) -> dict[str, object]:
    """The JSON schema of a tool's arguments, with its example."""
    (found,), components = msgspec.json.schema_components([tool.arguments])
    name = found["$ref"].rpartition("/")[2]
    examples = {"examples": [EXAMPLES[tool.name]]} if tool.name in EXAMPLES else {}
    return {**components[name], **examples, "additionalProperties": False, "type": "object"}


def read_arguments(tool: AssistantTool, given: object) -> ToolArguments:
    """Convert the arguments of a call. Raises BadJsonError, which names the argument that was meant."""
    fields = msgspec.structs.fields(tool.arguments)
    names = [each.name for each in fields]
    values: dict[str, object] = given if isinstance(given, dict) else {}
    for wrong in sorted(values.keys() - names):
        missing = [each.name for each in fields if each.required and each.name not in values]
        near = did_you_mean(wrong[:40], names) or (missing[0] if len(missing) == 1 else None)
        unknown, expected = repr(printable(wrong)[:40]), ", ".join(names) or "none"
        raise BadJsonError(f"unknown argument {unknown} of {tool.name!r}, expected {expected}{hint(near)}")
    return convert_json({} if given is None else given, tool.arguments)


def hint(near: str | None) -> str:
    """Return the question for the name that was meant, if any is near."""
    return f"; did you mean {near!r}?" if near else ""
