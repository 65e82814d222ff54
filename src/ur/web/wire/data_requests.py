"""Requests of pages about data of the robot, as JSON: topics, services, parameters. Hostile until they are read here.

A `Show` names what a page shows now, in place of what it showed before; the robot's end measures and sends only that.
A question has a number, `id`, by which the page knows the answer. What changes something carries `n` besides, the
newest beat of the server that the page has received: a request that waited in a connection is recognised by an old one.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, cast

from ur.web.wire.reading import BadRequestError, choose_reader, is_count, read_object

LONGEST = 16384
"""Characters of the longest request."""

LONGEST_VALUE = 8192
"""Characters of the value of a message, a call or a parameter, which is JSON."""

MOST_MEASURED = 24
"""Topics of one page whose rate is measured."""

MOST_IN_SCENE = 4
"""Topics of clouds and markers that one page shows."""

_NAME = re.compile(r"/[A-Za-z0-9_/~]{1,200}", re.ASCII)
_MESH = re.compile(r"package://[A-Za-z][\w-]{0,99}/[\w./ +-]{1,300}", re.ASCII)
_KIND = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,99}/[A-Za-z][A-Za-z0-9_]{0,99}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Show:
    """The contents of a page: `topics` lists all topics and measures those named; `echo` is one that is printed.

    `status`: diagnostics and the computer. `scene`: frames, and the clouds and markers of these topics.
    """

    topics: tuple[str, ...] | None = None
    echo: str = ""
    status: bool = False
    scene: tuple[str, ...] | None = None


@dataclass(frozen=True, slots=True)
class ListServices:
    """List the services."""


@dataclass(frozen=True, slots=True)
class ListParameters:
    """List the names of parameters."""


@dataclass(frozen=True, slots=True)
class GetParameter:
    """Read a parameter."""

    name: str


@dataclass(frozen=True, slots=True)
class DescribeMessage:
    """Describe an empty message of a type."""

    kind: str


@dataclass(frozen=True, slots=True)
class DescribeService:
    """Describe an empty request of a service."""

    service: str


@dataclass(frozen=True, slots=True)
class DescribeModel:
    """Describe the shapes of the robot."""


@dataclass(frozen=True, slots=True)
class DescribeMesh:
    """Describe a mesh by the address that the robot's description names."""

    address: str


@dataclass(frozen=True, slots=True)
class Publish:
    """Publish a message: `value` holds its fields as JSON."""

    topic: str
    kind: str
    value: str


@dataclass(frozen=True, slots=True)
class Call:
    """Call a service: `value` holds the fields of the request as JSON."""

    service: str
    value: str


@dataclass(frozen=True, slots=True)
class SetParameter:
    """Set a parameter to a value, which is JSON."""

    name: str
    value: str


Description = DescribeMessage | DescribeService | DescribeModel | DescribeMesh
Question = ListServices | ListParameters | GetParameter | Description
Change = Publish | Call | SetParameter
DataRequest = Show | Question | Change
CHANGES = (Publish, Call, SetParameter)


@dataclass(frozen=True, slots=True)
class DataEnvelope:
    """A request, its number (0 for `Show`), and the beat that it answers (0 where it changes nothing)."""

    number: int
    beat: int
    request: DataRequest


def read_data_request(text: object) -> DataEnvelope:
    """The request that a text is. Raises BadRequestError."""
    value = read_object(text, LONGEST)
    request = choose_reader(value, _READERS)(value)
    number = 0 if isinstance(request, Show) else _count(value, "id")
    return DataEnvelope(number, _count(value, "n") if isinstance(request, CHANGES) else 0, request)


def find_number(text: object) -> int:
    """The number of a request that is malformed, so that its page learns why; 0 where it has none."""
    try:
        found = read_object(text, LONGEST).get("id")
    except BadRequestError:
        return 0
    return cast("int", found) if is_count(found) else 0


def _count(value: Mapping[str, Any], name: str) -> int:
    found = value.get(name)
    if not is_count(found):
        raise BadRequestError(f"{name}: expected a whole number below 2^32")
    return int(cast("int", found))


def _name(value: Mapping[str, Any], key: str) -> str:
    return _match(_NAME, value.get(key), f"{key}: expected a full name, such as /scan")


def _kind(value: Mapping[str, Any]) -> str:
    return _match(_KIND, value.get("kind"), "kind: expected PACKAGE/NAME")


def _match(pattern: re.Pattern[str], value: object, message: str) -> str:
    if not isinstance(value, str) or pattern.fullmatch(value) is None:
        raise BadRequestError(message)
    return value


def _value(value: Mapping[str, Any]) -> str:
    found = value.get("value")
    if not isinstance(found, str) or len(found) > LONGEST_VALUE:
        raise BadRequestError(f"value: expected JSON of at most {LONGEST_VALUE} characters")
    return found


def _show(value: Mapping[str, Any]) -> Show:
    status = value.get("status", False)
    if not isinstance(status, bool):
        raise BadRequestError("status: expected true or false")
    echo = "" if value.get("echo") is None else _name(value, "echo")
    return Show(_names(value, "topics", MOST_MEASURED), echo, status, _names(value, "scene", MOST_IN_SCENE))


def _names(value: Mapping[str, Any], key: str, most: int) -> tuple[str, ...] | None:
    found = value.get(key)
    if found is None:
        return None
    if not isinstance(found, list) or len(found) > most:
        raise BadRequestError(f"{key}: expected a list of at most {most} names")
    return tuple(_name({key: each}, key) for each in found)


_READERS: Mapping[str, Callable[[Mapping[str, Any]], DataRequest]] = {
    "show": _show,
    "services": lambda _: ListServices(),
    "parameters": lambda _: ListParameters(),
    "parameter": lambda value: GetParameter(_name(value, "name")),
    "describe": lambda value: DescribeMessage(_kind(value)),
    "describe_service": lambda value: DescribeService(_name(value, "service")),
    "model": lambda _: DescribeModel(),
    "mesh": lambda value: DescribeMesh(_match(_MESH, value.get("mesh"), "mesh: expected package://PACKAGE/PATH")),
    "publish": lambda value: Publish(_name(value, "topic"), _kind(value), _value(value)),
    "call": lambda value: Call(_name(value, "service"), _value(value)),
    "set": lambda value: SetParameter(_name(value, "name"), _value(value)),
}
