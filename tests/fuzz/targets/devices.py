"""Bytes of boards and lidars, which noise, another device or a hostile one on the port may send."""

from collections.abc import Sequence
from pathlib import Path

from tests.fuzz.target import Target
from tests.ur_nodes.drivers.mutations import GROWTH, count_kept, parsers, stream


def _read(data: bytes, _: Path) -> None:
    """Each parser gets them twice, in pieces."""
    for make in parsers().values():
        parser = make()
        for at in range(0, len(data), 48):
            list(parser.take(data[at : at + 48]))
        list(parser.take(data))
        assert count_kept(parser) < GROWTH, f"{type(parser).__name__} keeps {count_kept(parser)} bytes"


def _seeds() -> Sequence[bytes]:
    return [b"".join(stream(name, 0.5)) for name in parsers()]


TARGETS = (Target("device_bytes", _read, (b"\x7e\x3c", b"\xaa\x55", b"\xa5\x5a", b"\x54\x2c", b"\x13", b"*"), _seeds),)
