import io

import numpy as np
import pytest
from PIL import Image

from ur_nodes.pictures.decode import (
    BadPictureError,
    Pixels,
    decode_picture,
    fit_picture,
    read_size,
    unpack_picture,
)


def make_picture(columns: int = 64, rows: int = 48) -> Pixels:
    """Left half red, right half blue."""
    pixels = np.zeros((rows, columns, 3), np.uint8)
    pixels[:, : columns // 2, 0] = 255
    pixels[:, columns // 2 :, 2] = 255
    return pixels


def pack(pixels: Pixels, form: str) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, form)
    return file.getvalue()


def test_png_comes_back_as_it_was() -> None:
    assert np.array_equal(decode_picture(pack(make_picture(), "PNG")), make_picture())


def test_jpeg_may_come_reduced_but_not_below_what_is_asked_for() -> None:
    pixels = decode_picture(pack(make_picture(640, 480), "JPEG"), (100, 75))
    assert 100 <= pixels.shape[1] < 640
    assert pixels[10, 5, 0] > 200 > 50 > pixels[10, 5, 2]


def test_size_is_read_without_decoding() -> None:
    assert read_size(pack(make_picture(64, 48), "JPEG")) == (64, 48)


@pytest.mark.parametrize("data", [b"", b"no picture", pack(make_picture(), "JPEG")[:200]])
def test_what_is_no_picture_is_refused(data: bytes) -> None:
    with pytest.raises(BadPictureError, match=f"{len(data)} bytes"):
        decode_picture(data)


@pytest.mark.parametrize(
    ("encoding", "pixel", "expected"),
    [
        ("rgb8", b"\x01\x02\x03", [1, 2, 3]),
        ("bgr8", b"\x03\x02\x01", [1, 2, 3]),
        ("rgba8", b"\x01\x02\x03\xff", [1, 2, 3]),
        ("mono8", b"\x07", [7, 7, 7]),
    ],
)
def test_raw_pictures_are_unpacked(encoding: str, pixel: bytes, expected: list[int]) -> None:
    row = pixel * 2 + b"\x00\x00"  # rows may be longer than the picture is wide
    pixels = unpack_picture(row * 3, 2, 3, len(row), encoding)
    assert pixels.shape == (3, 2, 3)
    assert pixels[1, 1].tolist() == expected


@pytest.mark.parametrize(("length", "encoding"), [(11, "rgb8"), (12, "yuv422")])
def test_raw_picture_that_is_short_or_of_an_unknown_kind_is_refused(length: int, encoding: str) -> None:
    with pytest.raises(BadPictureError, match="2 x 2, in encoding"):
        unpack_picture(bytes(length), 2, 2, 6, encoding)


@pytest.mark.parametrize(("box", "size"), [((32, 100), (24, 32)), ((100, 12), (12, 16)), ((1, 1), (1, 1))])
def test_fitted_picture_keeps_its_proportions(box: tuple[int, int], size: tuple[int, int]) -> None:
    assert fit_picture(make_picture(), *box).shape[:2] == size
