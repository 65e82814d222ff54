import random

from ur_nodes.drivers.frames import MORE, NONE, FrameReader, fixed


def make(payload: bytes) -> bytes:
    """A frame for the tests: two bytes of start, the length, the payload, and the sum of it all."""
    body = b"\xaa\x55" + bytes((len(payload),)) + payload
    return body + bytes((sum(body) & 0xFF,))


def reader() -> FrameReader:
    return FrameReader(
        b"\xaa\x55",
        lambda frame: frame[2] + 4 if len(frame) > 2 else MORE,
        lambda frame: sum(frame[:-1]) & 0xFF == frame[-1],
        40,
    )


def test_frames_are_found_in_pieces_of_any_size() -> None:
    frames = [make(bytes(range(size))) for size in range(1, 30)]
    for step in (1, 2, 3, 7, 1000):
        read, stream = reader(), b"".join(frames)
        found = [each for at in range(0, len(stream), step) for each in read.receive(stream[at : at + step])]
        assert found == frames
        assert read.rejected == 0


def test_damaged_frame_costs_itself_and_no_other() -> None:
    frames = [make(bytes((n,)) * 8) for n in range(3)]
    damaged = frames[1][:5] + b"\xff" + frames[1][6:]
    assert reader().receive(frames[0] + damaged + frames[2]) == [frames[0], frames[2]]


def test_half_a_frame_costs_no_other_even_if_its_length_reaches_into_the_next() -> None:
    frames = [make(bytes((n,)) * 8) for n in range(4)]
    assert reader().receive(frames[0] + frames[1][:6] + frames[2] + frames[3]) == [frames[0], frames[2], frames[3]]


def test_memory_stays_bounded_and_the_next_two_frames_are_found_after_any_noise() -> None:
    noise = random.Random(1)
    read, frame = reader(), make(b"payload")
    for _ in range(200):
        read.receive(noise.randbytes(noise.randrange(3000)))
        assert len(read._buffer) <= 40
        assert frame in [*read.receive(frame), *read.receive(frame), *read.receive(bytes(40))]
        read.clear()


def test_start_that_is_cut_at_the_end_of_the_bytes_is_kept() -> None:
    read, frame = reader(), make(b"x")
    assert read.receive(b"noise" + frame[:1]) == []
    assert read.receive(frame[1:]) == [frame]


def test_bytes_that_begin_no_frame_are_passed_over() -> None:
    read = FrameReader(b"\x7e", lambda frame: 3 if frame[1:2] == b"1" else MORE if len(frame) < 2 else NONE, bool, 3)
    assert read.receive(b"\x7e0\x7e1a") == [b"\x7e1a"]
    assert FrameReader(b"", fixed(2), lambda frame: frame == b"ab", 2).receive(b"xabab") == [b"ab", b"ab"]
