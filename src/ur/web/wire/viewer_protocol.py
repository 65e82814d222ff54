"""The protocol of Foxglove's WebSocket connections, as far as clients may use it. Untrusted until decoded here.

Subscriptions of a client are forwarded to the server of foxglove-sdk in decoded form. Goals and initial poses that it
publishes become requests like those of a page, and never reach that server. Published messages are in the form of ROS
1. The protocol is described at https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md.
"""

import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import msgspec
from msgspec import Meta

from ur.source.foreign.json_values import convert_json, read_json, write_json
from ur.web.wire.reading import BadRequestError

UPSTREAM = "foxglove.sdk.v1"
"""The name of the protocol that foxglove-sdk takes."""

SUBPROTOCOLS = (UPSTREAM, "foxglove.websocket.v1")
"""The names that clients use for it. The messages of both are the same."""

LONGEST = 1 << 17
"""Bytes of the longest message of a client."""

GOAL, POSE = "/move_base_simple/goal", "/initialpose"
SCHEMAS: Mapping[str, str] = {GOAL: "geometry_msgs/PoseStamped", POSE: "geometry_msgs/PoseWithCovarianceStamped"}
"""The type of each topic on which a client may publish."""

_MOST_IDS = 2000
_MOST_NAME = 256
_MESSAGE_DATA = 1  # the opcode of a published message
_DISTRIBUTION = "noetic"  # Lichtblick takes a server of this one for ROS 1, and knows its messages then
_HEAD = struct.Struct("<4I")
_POSE = struct.Struct("<7d")
_COVARIANCE = 36 * 8  # bytes
_PUBLISHED = struct.Struct("<BI")


_Number = Annotated[int, Meta(ge=0, le=2**63 - 1)]
_Numbers = Annotated[tuple[_Number, ...], Meta(max_length=_MOST_IDS)]
_Name = Annotated[str, Meta(max_length=_MOST_NAME)]


class _Wanted(msgspec.Struct, frozen=True):
    id: _Number
    channelId: _Number  # noqa: N815 - as the protocol has it


class _Subscribe(msgspec.Struct, frozen=True, tag_field="op", tag="subscribe"):
    subscriptions: Annotated[tuple[_Wanted, ...], Meta(max_length=_MOST_IDS)]


class _Unsubscribe(msgspec.Struct, frozen=True, tag_field="op", tag="unsubscribe"):
    subscriptionIds: _Numbers  # noqa: N815 - likewise


class AdvertisedTopic(msgspec.Struct, frozen=True, rename={"number": "id", "schema": "schemaName"}):
    """A topic on which the client is going to publish, with its channel number."""

    number: _Number
    topic: _Name
    schema: _Name
    encoding: _Name


class Advertisement(msgspec.Struct, frozen=True, tag_field="op", tag="advertise", rename={"topics": "channels"}):
    """Topics on which the client is going to publish."""

    topics: Annotated[tuple[AdvertisedTopic, ...], Meta(max_length=_MOST_IDS)]


class Withdrawal(msgspec.Struct, frozen=True, tag_field="op", tag="unadvertise", rename={"numbers": "channelIds"}):
    """Topics on which the client stops publishing, by their numbers."""

    numbers: _Numbers


@dataclass(frozen=True, slots=True)
class SubscriptionMessage:
    """A message about subscriptions; `text` contains its known fields only."""

    text: str


@dataclass(frozen=True, slots=True)
class Publication:
    """A message that the client publishes on the topic with this number."""

    number: int
    data: bytes


Message = SubscriptionMessage | Advertisement | Withdrawal | Publication
_KINDS: dict[Any, type[Any]] = {
    each.__struct_config__.tag: each for each in (_Subscribe, _Unsubscribe, Advertisement, Withdrawal)
}


def read_message(data: object) -> Message | None:
    """Decode the message of a client; None for a request that this server does not support. Raises BadRequestError."""
    if isinstance(data, bytes):
        if len(data) < _PUBLISHED.size or data[0] != _MESSAGE_DATA:
            return None
        return Publication(_PUBLISHED.unpack_from(data)[1], data[_PUBLISHED.size :])
    value = read_json(data, dict[str, object], LONGEST)
    operation = value.get("op")
    kind = _KINDS.get(operation) if isinstance(operation, str) else None
    if kind is None:
        return None
    found: _Subscribe | _Unsubscribe | Advertisement | Withdrawal = convert_json(value, kind)
    if isinstance(found, Advertisement):
        return Advertisement(
            tuple(msgspec.structs.replace(each, topic="/" + each.topic.lstrip("/")) for each in found.topics)
        )
    return SubscriptionMessage(write_json(found)) if isinstance(found, _Subscribe | _Unsubscribe) else found


def read_request_of(topic: str, data: bytes) -> dict[str, object]:
    """Convert a message on a topic of SCHEMAS to a page's request, without the challenge.

    Raises BadRequestError if it is malformed, or not in the map frame.
    """
    rest = _COVARIANCE if topic == POSE else 0
    try:
        length = _HEAD.unpack_from(data)[3]
        frame = data[_HEAD.size : _HEAD.size + length].decode("ascii").lstrip("/")
        x, y, _, *turn = _POSE.unpack_from(data, _HEAD.size + length)
        if len(data) != _HEAD.size + length + _POSE.size + rest or not all(map(math.isfinite, (x, y, *turn))):
            raise ValueError(data)
    except (struct.error, ValueError):
        raise BadRequestError(f"{topic}: expected a {SCHEMAS[topic]}") from None
    if frame != "map":
        raise BadRequestError(f"{topic}: a pose in the frame '{frame[:40]}', expected one in 'map'")
    size = math.hypot(*turn)
    if not 0.5 < size < 2.0:
        raise BadRequestError(f"{topic}: expected an orientation of length 1")
    qx, qy, qz, qw = (each / size for each in turn)
    yaw = math.atan2(2.0 * (qw * qz + qx * qy), 1.0 - 2.0 * (qy * qy + qz * qz))
    return {"t": "pose" if topic == POSE else "goal", "x": x, "y": y, "yaw": yaw}


def complete_server_info(text: str, *, publish: bool) -> str:
    """Return the first message of foxglove-sdk, extended by the gate: the capability to `publish`, and ROS 1."""
    value = read_json(text, dict[str, Any], len(text))
    if value.get("op") != "serverInfo":
        return text
    value["metadata"] = {**(value.get("metadata") or {}), "ROS_DISTRO": _DISTRIBUTION}
    value["capabilities"] = ["clientPublish"] if publish else []
    value["supportedEncodings"] = ["ros1"]
    return write_json(value)


def write_status(level: Literal["info", "warning", "error"], text: str) -> str:
    """Return a message whose text the client shows to its user."""
    return write_json({"op": "status", "level": ("info", "warning", "error").index(level), "message": text})
