"""The stand-in of a terminal."""

import pytest
from bench.stop_network_parts.screen import Screen

SHOWN = b"\x1b[H\x1b[J\x1b[1;1H  one\x1b[0m\x1b[K\x1b[2;1H\x1b[7;1mtwo\x1b[0m\x1b[K\x1b[3;1Hthree\x1b[K"


def test_lines_are_what_is_to_be_read() -> None:
    screen = Screen()
    screen.feed(SHOWN)
    assert screen.lines() == ["one", "two", "three"]


def test_lines_are_replaced_and_cleared() -> None:
    screen = Screen()
    screen.feed(SHOWN + b"\x1b[2;1Hnew\x1b[K\x1b[3;1H\x1b[J")
    assert screen.lines() == ["one", "new"]


@pytest.mark.parametrize("cut", range(1, len(SHOWN)))
def test_sequences_may_come_in_pieces(cut: int) -> None:
    screen = Screen()
    screen.feed(SHOWN[:cut])
    screen.feed(SHOWN[cut:])
    assert screen.lines() == ["one", "two", "three"]
