"""Requests of pages about data of the robot, as JSON: topics, services, parameters. Untrusted until decoded here.

A `Show` names the displayed data, in place of the previous request; the robot's process measures and sends only that. A
question has a number, `id`, which its answer repeats. A change also has `n`, the newest beat of the server that the
page has received: an old beat reveals a request that was delayed in a connection.
"""

from dataclasses import dataclass
from typing import Annotated

from msgspec import Meta

from ur.source.foreign.json_values import BadJsonError, Count, ForeignValue, convert_json, read_json
from ur.web.wire.reading import read_numbered

LONGEST = 16384
"""Characters of the longest request."""

LONGEST_VALUE = 8192
"""Characters of the value of a message, a call or a parameter, which is JSON."""

MOST_MEASURED = 24
"""Topics of one page whose rate is measured."""

MOST_IN_SCENE = 4
"""Topics of clouds and markers that one page shows."""

_Name = Annotated[str, Meta(pattern=r"^/[A-Za-z0-9_/~]{1,200}\Z", description="a full name, such as /scan")]
_Mesh = Annotated[
    str,
    Meta(
        pattern=r"^package://[A-Za-z][A-Za-z0-9_-]{0,99}/[A-Za-z0-9_./ +-]{1,300}\Z",
        description="package://PACKAGE/PATH",
    ),
]
_Kind = Annotated[
    str, Meta(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,99}/[A-Za-z][A-Za-z0-9_]{0,99}\Z", description="PACKAGE/NAME")
]
_Json = Annotated[str, Meta(max_length=LONGEST_VALUE, description=f"JSON of at most {LONGEST_VALUE} characters")]


class Show(ForeignValue, frozen=True, tag_field="t", tag="show"):
    """The content of a page: `topics` lists all topics and measures the named ones; `echo` is one to print.

    `status`: diagnostics and the computer. `scene`: frames, and the clouds and markers of these topics.
    """

    topics: Annotated[tuple[_Name, ...], Meta(max_length=MOST_MEASURED)] | None = None
    echo: _Name | None = None
    status: bool = False
    scene: Annotated[tuple[_Name, ...], Meta(max_length=MOST_IN_SCENE)] | None = None


class ListServices(ForeignValue, frozen=True, tag_field="t", tag="services"):
    """List the services."""


class ListParameters(ForeignValue, frozen=True, tag_field="t", tag="parameters"):
    """List the names of parameters."""


class GetParameter(ForeignValue, frozen=True, tag_field="t", tag="parameter"):
    """Read a parameter."""

    name: _Name


class DescribeMessage(ForeignValue, frozen=True, tag_field="t", tag="describe"):
    """Return a message of a type with default values."""

    kind: _Kind


class DescribeService(ForeignValue, frozen=True, tag_field="t", tag="describe_service"):
    """Return a request of a service with default values."""

    service: _Name


class DescribeModel(ForeignValue, frozen=True, tag_field="t", tag="model"):
    """Return the shapes of the robot."""


class DescribeMesh(ForeignValue, frozen=True, tag_field="t", tag="mesh", rename={"address": "mesh"}):
    """Return a mesh by its address in the robot's description."""

    address: _Mesh


class Publish(ForeignValue, frozen=True, tag_field="t", tag="publish"):
    """Publish a message whose fields `value` holds as JSON."""

    topic: _Name
    kind: _Kind
    value: _Json


class Call(ForeignValue, frozen=True, tag_field="t", tag="call"):
    """Call a service with the request fields that `value` holds as JSON."""

    service: _Name
    value: _Json


class SetParameter(ForeignValue, frozen=True, tag_field="t", tag="set"):
    """Set a parameter to a JSON value."""

    name: _Name
    value: _Json


Description = DescribeMessage | DescribeService | DescribeModel | DescribeMesh
Question = ListServices | ListParameters | GetParameter | Description
Change = Publish | Call | SetParameter
DataRequest = Show | Question | Change
CHANGES = (Publish, Call, SetParameter)


class _NumberOf(ForeignValue, frozen=True):
    id: Count
    n: object = None


class _ChangeHead(ForeignValue, frozen=True):
    id: Count
    n: Count


@dataclass(frozen=True, slots=True)
class DataEnvelope:
    """A request, its number (0 for `Show`), and the beat that it answers (0 if it changes nothing)."""

    number: int
    beat: int
    request: DataRequest


def read_data_request(text: object) -> DataEnvelope:
    """Decode a request. Raises BadRequestError."""
    request, fields = read_numbered(text, DataRequest, LONGEST)
    if isinstance(request, Show):
        return DataEnvelope(0, 0, request)
    if isinstance(request, CHANGES):
        head = convert_json(fields, _ChangeHead)
        return DataEnvelope(head.id, head.n, request)
    return DataEnvelope(convert_json(fields, _NumberOf).id, 0, request)


def find_number(text: object) -> int:
    """Return the number of a malformed request for its error message; 0 if it has none."""
    try:
        number: int = convert_json(read_json(text, dict[str, object], LONGEST).get("id"), Count)
    except BadJsonError:
        return 0
    return number
