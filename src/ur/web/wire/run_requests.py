"""Requests of pages about programs and runs, as JSON. Untrusted until decoded here.

Each has `n`, the newest beat of the server that the page has received: an old beat reveals a request that was delayed
in a connection. `id` is the page's number of the request, which the answer repeats.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Literal

import msgspec
from msgspec import Meta

from ur.source.foreign.json_values import Count, ForeignValue, convert_json, read_json
from ur.web.wire.reading import read_numbered

LONGEST = 16384
"""Characters of the longest request."""

MOST_ARGUMENTS = 60
LONGEST_VALUE = 256

NodeAction = Literal["start", "stop", "restart"]
_ProgramName = Annotated[
    str, Meta(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,63}(/[A-Za-z0-9_]{1,64})?\Z", description="NAME or PACKAGE/NAME")
]
_NodeName = Annotated[
    str, Meta(pattern=r"^/[A-Za-z0-9_/~]{1,200}\Z", description="a full name of a node, such as /amcl")
]
_ARGUMENTS = (
    f"at most {MOST_ARGUMENTS} values by names of letters, digits and '_', "
    f"each one line of at most {LONGEST_VALUE} characters without '$('"
)
_Arguments = Annotated[
    Mapping[
        Annotated[str, Meta(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,63}\Z")], Annotated[str, Meta(max_length=LONGEST_VALUE)]
    ],
    Meta(max_length=MOST_ARGUMENTS, description=_ARGUMENTS),
]
_RunId = Annotated[str, Meta(pattern=r"^[\w-]{1,60}\.[0-9]{1,10}\Z", description="the id of a run")]


class StartProgram(ForeignValue, frozen=True, tag_field="t", tag="start"):
    """Start a program with these arguments, by name."""

    program: _ProgramName
    arguments: _Arguments = msgspec.field(default_factory=dict)

    def __post_init__(self) -> None:
        # No part of a value is to be substituted.
        if not all(text.isprintable() and "$(" not in text for text in self.arguments.values()):
            raise ValueError(f"arguments: expected {_ARGUMENTS}")


class EndRun(ForeignValue, frozen=True, tag_field="t", tag="end"):
    """End a run."""

    run: _RunId


class ChangeNode(ForeignValue, frozen=True, tag_field="t", tag="node", rename={"action": "do"}):
    """Start, stop or restart a node of a run."""

    run: _RunId
    node: _NodeName
    action: NodeAction


RunRequest = StartProgram | EndRun | ChangeNode


class _Head(ForeignValue, frozen=True):
    n: Count
    id: Count


@dataclass(frozen=True, slots=True)
class Envelope:
    """A request, the beat that it answers, and its number."""

    beat: int
    number: int
    request: RunRequest


def read_run_request(text: object) -> Envelope:
    """Decode a request. Raises BadRequestError."""
    request, fields = read_numbered(text, RunRequest, LONGEST)
    head = convert_json(fields, _Head)
    return Envelope(head.n, head.id, request)


def read_program(program: object, arguments: str) -> StartProgram:
    """Decode the program and its arguments, as JSON, of a query. Raises BadRequestError."""
    return convert_json({"t": "start", "program": program, "arguments": read_json(arguments, dict)}, StartProgram)


def read_node_name(value: object) -> str:
    """Return a value that is a full node name. Raises BadRequestError."""
    name: str = convert_json(value, _NodeName)
    return name
