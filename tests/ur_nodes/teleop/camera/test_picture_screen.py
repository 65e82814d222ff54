import re
from dataclasses import replace

import numpy as np
import pytest

from ur_nodes.pictures.feed import FeedView
from ur_nodes.ports.values import PackedPicture
from ur_nodes.teleop.camera.picture_screen import describe_feed, describe_silence, draw_picture_screen

_COLOUR = re.compile(r"\x1b\[[0-9;]*m")


JPEG = PackedPicture(0, "camera", "jpeg", b"")


def bare(lines: list[str]) -> list[str]:
    return [_COLOUR.sub("", line) for line in lines]


def test_two_pixels_share_a_cell() -> None:
    picture = np.array([[[255, 0, 0]], [[0, 0, 255]]], np.uint8)
    lines = draw_picture_screen(picture, "", 1, 2, rich=True)
    assert lines[0] == "\x1b[38;2;255;0;0;48;2;0;0;255m▀\x1b[0m"


def test_terminal_of_256_colours_gets_the_nearest_of_its_cube() -> None:
    picture = np.array([[[250, 10, 0]], [[90, 140, 180]]], np.uint8)
    lines = draw_picture_screen(picture, "", 1, 2, rich=False)
    assert lines[0] == f"\x1b[38;5;{16 + 36 * 5};48;5;{16 + 36 + 6 * 2 + 3}m▀\x1b[0m"


@pytest.mark.parametrize(("columns", "rows"), [(80, 24), (20, 5), (1, 1), (7, 2)])
def test_screen_has_the_size_of_the_terminal(columns: int, rows: int) -> None:
    picture = np.zeros((max(1, 2 * (rows - 1) - 1), min(columns, 9), 3), np.uint8)
    lines = bare(draw_picture_screen(picture, "/camera/image   640 x 480", columns, rows, rich=True))
    assert len(lines) == rows
    assert all(len(line) <= columns for line in lines)


def test_advice_has_a_line_of_its_own_above_the_status() -> None:
    lines = bare(draw_picture_screen(None, "4 views", 40, 5, rich=True, advice=("tilt the board", "c calibrates")))
    assert lines[-2] == " tilt the board" + " " * 12 + "c calibrates "
    assert lines[-1].split() == ["4", "views", "q", "quits"]
    assert [len(lines), *map(len, lines[-2:])] == [5, 40, 40]


def test_status_is_the_last_line_and_says_how_to_leave() -> None:
    lines = bare(draw_picture_screen(None, "waiting", 40, 5, rich=True))
    assert lines[-1].startswith(" waiting")
    assert lines[-1].endswith("q quits ")
    assert lines[:-1] == [""] * 4


def test_status_has_size_rate_and_weight() -> None:
    view = FeedView("/camera/image/compressed")
    assert describe_feed(view) == "/camera/image/compressed: waiting for a publisher"
    assert describe_feed(replace(view, publishers=1)) == "/camera/image/compressed: waiting for the first picture"
    view = replace(view, picture=JPEG, size=(640, 480), length=23_400, rate=10.0)
    expected = "/camera/image/compressed   640 x 480   10.0 pictures a second   23 kB each"
    assert describe_feed(view) == expected
    assert describe_feed(replace(view, silence=5.0)) == "/camera/image/compressed: no picture for 5 s"


def test_reason_for_silence_is_shown_after_three_seconds() -> None:
    view = FeedView("/camera/image", reason="no node publishes it")
    assert describe_silence(replace(view, silence=2.9)) == ""
    assert describe_silence(replace(view, silence=3.2, reason="")) == "no picture on /camera/image for 3 s"
    assert describe_silence(replace(view, silence=4.2)) == "no picture on /camera/image for 4 s: no node publishes it"


def test_long_reason_is_wrapped_and_shown_whole_whatever_the_picture() -> None:
    reason = "no picture on /camera/image for 3 s: /simulator: " + "OpenGL is not installed " * 3
    for picture in (None, np.zeros((20, 40, 3), np.uint8)):
        lines = bare(draw_picture_screen(picture, "status", 40, 11, rich=True, notice=reason))
        assert len(lines) == 11
        assert all(len(line) <= 40 for line in lines)
        assert reason.split() == [word for line in lines[:-1] if "▀" not in line for word in line.split()]
