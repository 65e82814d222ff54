"""Requests about data of the robot, as they come from a browser."""

import json
from typing import Any

import pytest

from ur.web.wire.data_requests import (
    DataEnvelope,
    DescribeMesh,
    DescribeModel,
    Show,
    find_number,
    pack_frame,
    pack_json,
    read_data_request,
    unpack_frame,
)
from ur.web.wire.reading import BadRequestError


def read(**value: Any) -> DataEnvelope:
    return read_data_request(json.dumps(value))


def test_requests_are_read() -> None:
    assert read(t="show") == DataEnvelope(0, Show())
    assert read(t="show", topics=["/a"], echo="/b").request == Show(("/a",), "/b")
    assert read(t="show", status=True, scene=["/a"]).request == Show(status=True, scene=("/a",))
    assert read(t="mesh", id=4, mesh="package://demo/a.stl").request == DescribeMesh("package://demo/a.stl")
    assert read(t="model", id=4, n=2) == DataEnvelope(4, DescribeModel())


@pytest.mark.parametrize(
    "value",
    [
        {"t": "show", "topics": ["a"]},
        {"t": "show", "topics": ["/a"] * 25},
        {"t": "show", "topics": "/a"},
        {"t": "show", "echo": "/a b"},
        {"t": "show", "echo": 4},
        {"t": "show", "status": 1},
        {"t": "show", "scene": ["/a"] * 5},
        {"t": "mesh", "id": 1, "mesh": "file:///etc/passwd"},
        {"t": "model"},
        {"t": "shell"},
    ],
)
def test_malformed_requests_are_refused(value: dict[str, Any]) -> None:
    with pytest.raises(BadRequestError):
        read_data_request(json.dumps(value))


def test_number_of_a_malformed_request_is_found() -> None:
    assert find_number('{"t": "x", "id": 7}') == 7
    assert find_number('{"t": "x", "id": true}') == 0
    assert find_number("[") == 0
    assert find_number(None) == 0


def test_frames_come_back_as_they_were() -> None:
    frame = unpack_frame(pack_frame(7, "cloud:/küche", b"\x00\x01"))
    assert (frame.page, frame.key, frame.body) == (7, "cloud:/küche", b"\x00\x01")
    assert unpack_frame(pack_json(0, "", {"t": "x"})).body == b'{"t":"x"}'
    with pytest.raises(ValueError, match="JSON compliant"):
        pack_json(0, "", {"t": float("nan")})
    for data in (b"", b"\x00" * 4, b"\x00\x00\x00\x00\x09abc"):
        with pytest.raises(ValueError, match="frame of"):
            unpack_frame(data)
