"""The protocol of Foxglove's WebSocket connections, as far as clients may use it: hostile until it is read here.

A client subscribes, which is passed on to the server of foxglove-sdk as it has been read; and it publishes goals and
initial poses, which become requests as a page makes them and never reach that server. Published messages are in the
form of ROS 1. The protocol is described at https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, cast

from ur.web.wire.reading import BadRequestError, read_object

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


@dataclass(frozen=True, slots=True)
class SubscriptionMessage:
    """A message about subscriptions; `text` is what it says, and nothing else that came with it."""

    text: str


@dataclass(frozen=True, slots=True)
class AdvertisedTopic:
    """A topic on which the client is going to publish, with the number that it gives it."""

    number: int
    topic: str
    schema: str
    encoding: str


@dataclass(frozen=True, slots=True)
class Advertisement:
    """Topics on which the client is going to publish."""

    topics: tuple[AdvertisedTopic, ...]


@dataclass(frozen=True, slots=True)
class Withdrawal:
    """Topics on which the client publishes no more, by their numbers."""

    numbers: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Publication:
    """A message that the client publishes on the topic with this number."""

    number: int
    data: bytes


Message = SubscriptionMessage | Advertisement | Withdrawal | Publication


def read_message(data: object) -> Message | None:
    """The message of a client; None for one that asks for what this server does not offer. Raises BadRequestError."""
    if isinstance(data, bytes):
        if len(data) < _PUBLISHED.size or data[0] != _MESSAGE_DATA:
            return None
        return Publication(_PUBLISHED.unpack_from(data)[1], data[_PUBLISHED.size :])
    if not isinstance(data, str) or len(data) > LONGEST:
        raise BadRequestError(f"expected a message of at most {LONGEST} bytes")
    value = read_object(data, LONGEST)
    operation = value.get("op")
    if operation == "subscribe":
        wanted = [
            {"id": _number(each, "id"), "channelId": _number(each, "channelId")}
            for each in _list(value, "subscriptions")
        ]
        return SubscriptionMessage(json.dumps({"op": "subscribe", "subscriptions": wanted}))
    if operation == "unsubscribe":
        numbers = _numbers(value, "subscriptionIds")
        return SubscriptionMessage(json.dumps({"op": "unsubscribe", "subscriptionIds": numbers}))
    if operation == "advertise":
        return Advertisement(tuple(_advertised(each) for each in _list(value, "channels")))
    if operation == "unadvertise":
        return Withdrawal(tuple(_numbers(value, "channelIds")))
    return None


def read_request_of(topic: str, data: bytes) -> dict[str, Any]:
    """The request of a page that a message on a topic of SCHEMAS is, but for the challenge that the client proves.

    Raises BadRequestError: it is malformed, or not in the map frame.
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
    """The first message of foxglove-sdk, with what the gate offers besides: to `publish`, and that this is ROS 1."""
    value = json.loads(text)
    if not isinstance(value, dict) or value.get("op") != "serverInfo":
        return text
    value["metadata"] = {**(value.get("metadata") or {}), "ROS_DISTRO": _DISTRIBUTION}
    value["capabilities"] = ["clientPublish"] if publish else []
    value["supportedEncodings"] = ["ros1"]
    return json.dumps(value)


def write_status(level: Literal["info", "warning", "error"], text: str) -> str:
    """A line that the client shows to its user."""
    return json.dumps({"op": "status", "level": ("info", "warning", "error").index(level), "message": text})


def _list(value: Mapping[str, Any], name: str) -> list[Any]:
    found = value.get(name)
    if not isinstance(found, list) or len(found) > _MOST_IDS:
        raise BadRequestError(f"{name}: expected a list of at most {_MOST_IDS}")
    return found


def _numbers(value: Mapping[str, Any], name: str) -> list[int]:
    return [_number({name: each}, name) for each in _list(value, name)]


def _number(value: object, name: str) -> int:
    found = value.get(name) if isinstance(value, dict) else None
    if type(found) is not int or not 0 <= found < 2**63:
        raise BadRequestError(f"{name}: expected a whole number")
    return found


def _advertised(value: object) -> AdvertisedTopic:
    number = _number(value, "id")
    found = cast("dict[str, Any]", value)
    texts = [found.get(name) for name in ("topic", "schemaName", "encoding")]
    if not all(isinstance(each, str) and len(each) <= _MOST_NAME for each in texts):
        raise BadRequestError("channels: expected topic, schemaName and encoding")
    topic, schema, encoding = cast("list[str]", texts)
    return AdvertisedTopic(number, "/" + topic.lstrip("/"), schema, encoding)
