"""Pictures within limits."""

import io
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image
from tests.fakes.pictures import make_png

from ur.source.foreign.pictures import MAP_FORMATS, open_picture


def _jpeg() -> bytes:
    buffer = io.BytesIO()
    Image.new("L", (8, 8)).save(buffer, "JPEG")
    return buffer.getvalue()


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (lambda: make_png(8900, 8900, 16, 6), "79210000|take 316,840,000 bytes"),
        (lambda: make_png(8900, 8900, 8, 2), "take 237,630,000 bytes"),
        (lambda: make_png(9000, 9000, 8, 0), "pixels are too many"),
        (lambda: make_png(2**31 - 1, 2**31 - 1, 8, 0), "pixels|exceeds"),
        (lambda: b"P5\n#" + b"x" * 30_000_000 + b"\n2 2\n255\n\0\0\0\0", "too many comments"),
        (lambda: b"P5\n" + b"#\n" * 15_000_000 + b"2 2\n255\n\0\0\0\0", "too many comments"),
        (lambda: b"P5\n2 2" + b" " * 30_000_000 + b"\n255\n\0\0\0\0", "too many comments"),
        (lambda: b"P2\n2000 2000\n255\n" + b"#\n0 " * 4_000_000, "a PNM in digits"),
        (lambda: b"\xff\xd8" + b"\xff\xe1\x00\x02" * 4_000_000 + _jpeg()[2:], "too many comments"),
        (lambda: b"GIF89a\1\0\1\0\0\0\0" + b"\x21\xfe\x01x\0" * 4_000_000, "too many comments"),
    ],
    ids=["large", "wide", "many", "widest", "comment", "comments", "spaces", "digits", "JPEG comments", "GIF comments"],
)
def test_sizes_are_refused_before_they_are_unpacked(data: Callable[[], bytes], reason: str) -> None:
    with pytest.raises(ValueError, match=reason), open_picture(io.BytesIO(data()), MAP_FORMATS):
        pass


def test_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "map.pgm")
    with pytest.raises(OSError, match="not a regular file"), open_picture(tmp_path / "map.pgm", MAP_FORMATS):
        pass


def test_picture_outside_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    Image.new("L", (2, 2)).save(tmp_path / "a.png")
    (tmp_path / "inner" / "b.png").symlink_to("../a.png")
    with (
        pytest.raises(OSError, match="outside"),
        open_picture(tmp_path / "inner" / "b.png", MAP_FORMATS, inside=tmp_path / "inner"),
    ):
        pass


def test_map_with_a_comment_is_read() -> None:
    with open_picture(io.BytesIO(b"P5\n# CREATOR: map_saver\n2 2\n255\n\1\2\3\4"), MAP_FORMATS) as image:
        assert image.tobytes() == b"\1\2\3\4"
