import pytest
from hypothesis import given
from hypothesis import strategies as st

from ur_nodes.teleop.terminal.keys import FocusLost, Key, KittyFlags, decode_keys


@pytest.mark.parametrize(
    ("data", "event"),
    [
        (b"i", Key("i")),
        (b"I", Key("I")),
        (b" ", Key("space")),
        (b"\r", Key("enter")),
        (b"\x03", Key("c", ctrl=True)),
        (b"\x1b[A", Key("up")),
        (b"\x1bOB", Key("down")),
        (b"\x1b[1;2C", Key("right")),
        ("é".encode(), Key("é")),
        (b"\x1b[105u", Key("i")),
        (b"\x1b[105;1:1u", Key("i")),
        (b"\x1b[105;1:2u", Key("i", "repeat")),
        (b"\x1b[105;1:3u", Key("i", "release")),
        (b"\x1b[105;2u", Key("I")),
        (b"\x1b[105:73;2:3u", Key("I", "release")),
        (b"\x1b[44:60;2u", Key("<")),
        (b"\x1b[105;65u", Key("i")),  # caps lock is not shift
        (b"\x1b[99;5u", Key("c", ctrl=True)),
        (b"\x1b[1;1:3D", Key("left", "release")),
        (b"\x1b[57419;1:3u", Key("up", "release")),
        (b"\x1b[32;1:3u", Key("space", "release")),
        (b"\x1b[?15u", KittyFlags(15)),
        (b"\x1b[O", FocusLost()),
    ],
)
def test_sequence_is_decoded(data: bytes, event: object) -> None:
    assert decode_keys(data) == ((event,), b"")


@pytest.mark.parametrize(
    "data",
    [
        b"\x1b[57441;2u",  # shift itself
        b"\x1bi",  # alt
        b"\x1b[105;3u",  # alt in the kitty protocol
        b"\x1b[?62;22c",  # device attributes
        b"\x1b[I",
        b"\x1b[99999999;1u",
        b"\xff",
    ],
)
def test_sequence_without_meaning_is_skipped(data: bytes) -> None:
    assert decode_keys(data + b"i") == ((Key("i"),), b"")


@pytest.mark.parametrize("data", [b"\x1b", b"\x1b[", b"\x1b[105;1:", b"\x1bO", b"\xc3", b"\xe2\x96"])
def test_incomplete_sequence_waits_for_the_rest(data: bytes) -> None:
    assert decode_keys(b"j" + data) == ((Key("j"),), data)


def test_lone_escape_is_the_key_when_nothing_follows() -> None:
    assert decode_keys(b"\x1b", final=True) == ((Key("escape"),), b"")


@given(st.binary(max_size=200), st.booleans())
def test_decoding_never_fails_and_leaves_little(data: bytes, final: bool) -> None:
    _, rest = decode_keys(data, final=final)
    assert data.endswith(rest)
    assert len(rest) < 64
    assert not (final and rest)


@given(st.lists(st.sampled_from([b"i", b"\x1b[A", b"\x1b[105;1:3u", "é".encode(), b"\x1b[?15u"])), st.integers(0, 60))
def test_decoding_in_two_pieces_gives_the_same_events(parts: list[bytes], cut: int) -> None:
    data = b"".join(parts)
    first, rest = decode_keys(data[:cut])
    second, _ = decode_keys(rest + data[cut:])
    assert first + second == decode_keys(data)[0]
