"""Requests of pages about programs and runs, as JSON: hostile until they are read here.

Each carries `n`, the newest beat of the server that the page has received: a request that waited in a connection
is recognised by an old one. `id` is the page's number of the request, by which it knows the answer.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast

from ur.web.wire.reading import BadRequestError, choose_reader, is_count, read_object

LONGEST = 16384
"""Characters of the longest request."""

MOST_ARGUMENTS = 60
LONGEST_VALUE = 256

NodeAction = Literal["start", "stop", "restart"]
_ACTIONS = ("start", "stop", "restart")
_PROGRAM = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,63}(/[A-Za-z0-9_]{1,64})?", re.ASCII)
_ARGUMENT = re.compile(r"[A-Za-z_][A-Za-z0-9_]{0,63}", re.ASCII)
_RUN = re.compile(r"[\w-]{1,60}\.[0-9]{1,10}")
_NODE = re.compile(r"/[A-Za-z0-9_/~]{1,200}", re.ASCII)


@dataclass(frozen=True, slots=True)
class StartProgram:
    """Start a program with these arguments, by name."""

    program: str
    arguments: Mapping[str, str]


@dataclass(frozen=True, slots=True)
class EndRun:
    """End a run."""

    run: str


@dataclass(frozen=True, slots=True)
class ChangeNode:
    """Start, stop or restart a node of a run."""

    run: str
    node: str
    action: NodeAction


RunRequest = StartProgram | EndRun | ChangeNode


@dataclass(frozen=True, slots=True)
class Envelope:
    """A request, the beat that it answers, and its number."""

    beat: int
    number: int
    request: RunRequest


def read_run_request(text: object) -> Envelope:
    """The request that a text is. Raises BadRequestError."""
    value = read_object(text, LONGEST)
    reader = choose_reader(value, _READERS)
    return Envelope(_count(value, "n"), _count(value, "id"), reader(value))


def read_program_name(value: object) -> str:
    """A name of a program. Raises BadRequestError."""
    return _match(_PROGRAM, value, "program: expected NAME or PACKAGE/NAME")


def read_node_name(value: object) -> str:
    """A full name of a node. Raises BadRequestError."""
    return _match(_NODE, value, "node: expected a full name of a node, such as /amcl")


def read_arguments(value: object) -> Mapping[str, str]:
    """Values of arguments by name. Raises BadRequestError.

    A value is one line of printable text without `$(`: nothing of it is to be substituted.
    """
    if not isinstance(value, dict) or len(value) > MOST_ARGUMENTS:
        raise BadRequestError(f"arguments: expected an object of at most {MOST_ARGUMENTS} values")
    for name, text in value.items():
        _match(_ARGUMENT, name, "arguments: expected names of letters, digits and '_'")
        good = isinstance(text, str) and len(text) <= LONGEST_VALUE and (text.isprintable() or not text)
        if not good or "$(" in text:
            message = f"{name}: expected one line of at most {LONGEST_VALUE} characters without '$('"
            raise BadRequestError(message)
    return cast("Mapping[str, str]", value)


def _match(pattern: re.Pattern[str], value: object, message: str) -> str:
    if not isinstance(value, str) or pattern.fullmatch(value) is None:
        raise BadRequestError(message)
    return value


def _count(value: Mapping[str, Any], name: str) -> int:
    found = value.get(name)
    if not is_count(found):
        raise BadRequestError(f"{name}: expected a whole number below 2^32")
    return int(cast("int", found))


def _run(value: Mapping[str, Any]) -> str:
    return _match(_RUN, value.get("run"), "run: expected the id of a run")


def _change(value: Mapping[str, Any]) -> ChangeNode:
    action = value.get("do")
    if not isinstance(action, str) or action not in _ACTIONS:
        raise BadRequestError(f"do: expected one of {', '.join(_ACTIONS)}")
    return ChangeNode(_run(value), read_node_name(value.get("node")), cast("NodeAction", action))


_READERS: Mapping[str, Callable[[Mapping[str, Any]], RunRequest]] = {
    "start": lambda value: StartProgram(
        read_program_name(value.get("program")), read_arguments(value.get("arguments", {}))
    ),
    "end": lambda value: EndRun(_run(value)),
    "node": _change,
}
