import json
import math
import os
import random
import struct

import pytest
from tests.fuzz.mutate import mutate

from ur.web.wire.reading import BadRequestError
from ur.web.wire.requests import GoalRequest, InitialPose, read_request
from ur.web.wire.viewer_protocol import (
    GOAL,
    POSE,
    AdvertisedTopic,
    Advertisement,
    Publication,
    SubscriptionMessage,
    Withdrawal,
    complete_server_info,
    read_message,
    read_request_of,
    write_status,
)

COUNT = int(os.environ.get("UR_WEB_FUZZ", "2000"))


def pose(x: float = 1.0, y: float = 2.0, yaw: float = 0.5, frame: bytes = b"map", rest: int = 0) -> bytes:
    head = struct.pack("<4I", 7, 1, 2, len(frame)) + frame
    return head + struct.pack("<7d", x, y, 0.0, 0.0, 0.0, math.sin(yaw / 2), math.cos(yaw / 2)) + bytes(rest)


def test_subscriptions_are_passed_on_without_what_else_came_with_them() -> None:
    text = '{"op": "subscribe", "x": 1, "subscriptions": [{"id": 1, "channelId": 2, "evil": "y"}]}'
    found = read_message(text)
    assert isinstance(found, SubscriptionMessage)
    assert json.loads(found.text) == {"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 2}]}
    found = read_message('{"op": "unsubscribe", "subscriptionIds": [1, 2]}')
    assert isinstance(found, SubscriptionMessage)
    assert json.loads(found.text) == {"op": "unsubscribe", "subscriptionIds": [1, 2]}


def test_what_is_not_offered_is_left_out() -> None:
    for operation in ("getParameters", "setParameters", "fetchAsset", "subscribeConnectionGraph", "x", None, 3):
        assert read_message(json.dumps({"op": operation})) is None
    for data in (b"", b"\x01", b"\x02" + bytes(20)):
        assert read_message(data) is None


def test_topics_and_messages_of_clients_are_read() -> None:
    channel = {"id": 3, "topic": "initialpose", "schemaName": "x/Y", "encoding": "ros1"}
    text = json.dumps({"op": "advertise", "channels": [channel]})
    assert read_message(text) == Advertisement((AdvertisedTopic(3, POSE, "x/Y", "ros1"),))
    assert read_message('{"op": "unadvertise", "channelIds": [3]}') == Withdrawal((3,))
    assert read_message(struct.pack("<BI", 1, 3) + b"data") == Publication(3, b"data")


@pytest.mark.parametrize(("topic", "rest", "kind"), [(GOAL, 0, GoalRequest), (POSE, 288, InitialPose)])
def test_poses_in_the_form_of_ros_become_requests_of_a_page(topic: str, rest: int, kind: type) -> None:
    found = read_request(json.dumps({**read_request_of(topic, pose(rest=rest)), "n": [5, 6]}))
    assert isinstance(found, kind)
    assert isinstance(found, (GoalRequest, InitialPose))
    assert (found.answers, found.x, found.y) == ((5, 6), 1.0, 2.0)
    assert found.yaw == pytest.approx(0.5)


@pytest.mark.parametrize(
    "data",
    [
        b"",
        pose()[:-1],
        pose() + b"x",
        pose(rest=288),
        pose(x=math.nan),
        pose(y=math.inf),
        pose(frame=b"odom"),
        pose(frame=b"\xff"),
        struct.pack("<4I", 0, 0, 0, 2**32 - 1) + bytes(60),
        struct.pack("<4I", 0, 0, 0, 3) + b"map" + bytes(56),  # an orientation of length 0
    ],
)
def test_malformed_poses_are_refused(data: bytes) -> None:
    with pytest.raises(BadRequestError, match="expected"):
        read_request_of(GOAL, data)


def test_server_info_offers_what_the_role_may_do() -> None:
    text = json.dumps({"op": "serverInfo", "name": "ur", "capabilities": ["x"], "metadata": {"a": "b"}})
    for publish in (True, False):
        value = json.loads(complete_server_info(text, publish=publish))
        assert value["capabilities"] == (["clientPublish"] if publish else [])
        assert value["metadata"] == {"a": "b", "ROS_DISTRO": "noetic"}
    assert complete_server_info('{"op": "advertise"}', publish=True) == '{"op": "advertise"}'
    assert json.loads(write_status("error", "x")) == {"op": "status", "level": 2, "message": "x"}


def test_broken_messages_are_read_or_refused() -> None:
    chance = random.Random(COUNT)
    seeds = [
        b'{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 2}]}',
        b'{"op": "advertise", "channels": [{"id": 3, "topic": "/x", "schemaName": "y/Z", "encoding": "ros1"}]}',
        struct.pack("<BI", 1, 3) + pose(),
    ]
    words: tuple[bytes, ...] = (b"NaN", b"1e999", b"-1", b"[", b"{", b"null", b"\x00", b"\xff", b"18446744073709551616")
    for _ in range(COUNT):
        data = mutate(seeds, words, chance)
        for message in (data, data.decode("utf-8", "replace")):
            assert "\n" not in refusal_of(message)


def refusal_of(message: object) -> str:
    """Why a message is refused; empty for one that is read."""
    try:
        found = read_message(message)
        if isinstance(found, Publication):
            read_request_of(GOAL, found.data)
    except BadRequestError as problem:
        return str(problem)
    return ""
