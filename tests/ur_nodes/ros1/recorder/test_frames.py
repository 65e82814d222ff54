"""Messages in a stream that arrives in any parts."""

from __future__ import annotations

import itertools
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.ros1.recorder.receiver import MOST_BYTES, FrameError, Frames


@given(st.lists(st.binary(max_size=40), max_size=12), st.lists(st.integers(0, 400), max_size=12))
def test_messages_are_those_that_were_sent(messages: list[bytes], cuts: list[int]) -> None:
    stream = b"".join(struct.pack("<I", len(each)) + each for each in messages)
    places = sorted({0, len(stream), *(min(each, len(stream)) for each in cuts)})
    frames = Frames()
    found = []
    for begin, end in itertools.pairwise(places):
        found += frames.feed(memoryview(stream[begin:end]))
    assert found == messages


def test_length_that_no_message_has_is_refused() -> None:
    with pytest.raises(FrameError):
        Frames().feed(memoryview(struct.pack("<I", MOST_BYTES + 1)))
