"""Recordings: MCAP files, from any recorder."""

import io
from collections.abc import Sequence
from contextlib import suppress
from itertools import islice
from pathlib import Path

from mcap.writer import CompressionType, Writer
from tests.fuzz.target import Target

from ur.recordings.mcap_file import describe_recording, open_recording
from ur.source.diagnostic import UserError

_WORDS = (
    *(b"\x89MCAP0\r\n", b"zstd", b"lz4", b"\x28\xb5\x2f\xfd", b"\x04\x22\x4d\x18", b"\x01", b"\x03", b"\x04", b"\x05"),
    *(b"\x06", b"\x08", b"\x0b", b"\x0c", b"\x0d", b"\x0f", bytes(8), b"\xff" * 8, b"\x00\x00\x00\x00\x01\x00\x00\x00"),
    *(b"std_msgs/String", b"ros1msg", b"ros2msg", b"/rosout", b"events", b"\x1b]0;x\x07"),
)


def make_recording(compression: CompressionType, payload: bytes = b"\x04\x00\x00\x00word", chunk: int = 200) -> bytes:
    """A recording of texts, in chunks of so many bytes."""
    file = io.BytesIO()
    writer = Writer(file, chunk_size=chunk, compression=compression)
    writer.start(profile="ros1", library="fuzz")
    schema = writer.register_schema("std_msgs/String", "ros1msg", b"string data\n")
    channel = writer.register_channel("/words", "ros1", schema)
    for number in range(20):
        writer.add_message(channel, number, payload, number)
    writer.add_metadata("events", {"1.0": "a bumper"})
    writer.finish()  # type: ignore[no-untyped-call]
    return file.getvalue()


def _read(data: bytes, folder: Path) -> None:
    path = folder / "a.mcap"
    path.write_bytes(data)
    with suppress(UserError):
        recording = open_recording(path)
        list(describe_recording(recording))
        for topics in (None, {"/words"}):
            list(islice(recording.messages(3, topics), 10_000))


def _seeds() -> Sequence[bytes]:
    return [make_recording(each) for each in CompressionType]


TARGETS = (Target("recording", _read, _WORDS, _seeds),)
