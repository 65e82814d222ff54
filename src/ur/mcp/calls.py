"""The tools of the server: their names, what they do, and their arguments with limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import msgspec
from msgspec import Meta, field

from ur.source.foreign.json_values import PrintableValue

_Word = Annotated[str, Meta(max_length=300, pattern="^[^-]")]
_WORDS = "at most 20 texts, none of which begins with a dash"
_Words = Annotated[tuple[_Word, ...], Meta(max_length=20, description=_WORDS)]
_Metres = Annotated[float, Meta(ge=-1e5, le=1e5, description="metres in the frame of the map")]


class ToolArguments(PrintableValue, frozen=True):
    """Arguments of a tool."""


class NothingGiven(ToolArguments, frozen=True):
    """Nothing."""


class NamesGiven(ToolArguments, frozen=True):
    """Names of packages, paths of files, or what the tool describes."""

    arguments: _Words = ()


class PlaceGiven(ToolArguments, frozen=True):
    """A place of the map; the heading in degrees, to the left of the x axis."""

    x: _Metres
    y: _Metres
    heading: Annotated[float, Meta(ge=-360.0, le=360.0)] | None = None
    seconds: Annotated[float, Meta(gt=0.0, le=120.0)] = 60.0


class VelocityGiven(ToolArguments, frozen=True):
    """A velocity, m/s forward and rad/s to the left, for so many seconds."""

    forward: Annotated[float, Meta(ge=-2.0, le=2.0)]
    turn: Annotated[float, Meta(ge=-4.0, le=4.0)] = 0.0
    seconds: Annotated[float, Meta(gt=0.0, le=5.0)] = 1.0


class TimeGiven(ToolArguments, frozen=True):
    """Seconds at most."""

    seconds: Annotated[float, Meta(gt=0.0, le=120.0)] = 60.0


class GrantAsked(ToolArguments, frozen=True):
    """For how long, how fast (m/s), and why."""

    minutes: Annotated[float, Meta(gt=0.0, le=1440.0)] = 30.0
    speed: Annotated[float, Meta(ge=0.01, le=2.0)] = 0.2
    reason: Annotated[str, Meta(max_length=200)] = ""


class ProgramGiven(ToolArguments, frozen=True):
    """A program of `ur list`, and arguments of its launch file."""

    name: Annotated[str, Meta(pattern=r"^[a-z][a-z0-9_]{0,40}$")]
    arguments: Annotated[dict[str, str], Meta(max_length=20)] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class AssistantTool:
    """A tool; `verb` is the command of `ur` that it runs, '' for none."""

    name: str
    text: str
    arguments: type[ToolArguments]
    verb: tuple[str, ...] = ()


TOOLS = {
    each.name: each
    for each in (
        AssistantTool(
            "look", "Look at the robot: pose, what is near, battery, goal, who drives, the grant.", NothingGiven
        ),
        AssistantTool("list", "List the programs that can run on the robot.", NothingGiven, ("list",)),
        AssistantTool(
            "check", "Check launch files, YAML files and packages; nothing in them runs.", NamesGiven, ("check",)
        ),
        AssistantTool(
            "explain", "Explain where a name in a launch file got its value: FILE NAME.", NamesGiven, ("explain",)
        ),
        AssistantTool(
            "find", "Find where a name in launch files is defined and used: NAME, then folders.", NamesGiven, ("find",)
        ),
        AssistantTool(
            "graph", "Describe what a launch file includes and starts: PACKAGE FILE.", NamesGiven, ("graph",)
        ),
        AssistantTool("doctor", "Find what is wrong between this computer and the robot.", NothingGiven, ("doctor",)),
        AssistantTool(
            "ask_to_drive",
            "Ask the person for a grant to drive; it is given on the robot's page or in a terminal.",
            GrantAsked,
        ),
        AssistantTool(
            "go_to",
            "Drive to a place of the map, around obstacles, and wait until it is there.",
            PlaceGiven,
        ),
        AssistantTool("drive", "Drive at a velocity for at most 5 s, then stop.", VelocityGiven),
        AssistantTool(
            "explore", "Drive to places from which the map grows, and wait; call again until it is complete.", TimeGiven
        ),
        AssistantTool("stop", "Stop what this assistant drives.", NothingGiven),
        AssistantTool(
            "start_program", "Start a program on the robot; the grant has to include programs.", ProgramGiven
        ),
        AssistantTool(
            "end_program", "End a program that was started; the grant has to include programs.", ProgramGiven
        ),
    )
}


def schema_of(tool: AssistantTool) -> dict[str, object]:
    """The JSON schema of a tool's arguments."""
    (found,), components = msgspec.json.schema_components([tool.arguments])
    name = found["$ref"].rpartition("/")[2]
    return {**components[name], "additionalProperties": False, "type": "object"}
