import numpy as np
import pytest
from tests.ur_nodes.camera.fake_device import make_jpeg

from ur_nodes.camera.formats import (
    OfferedFormat,
    SizeRange,
    choose_format,
    decode_jpeg,
    encode_jpeg,
    flip_pixels,
    trim_jpeg,
    unpack_raw,
)
from ur_nodes.pictures.decode import Pixels


def make_pixels() -> Pixels:
    """Left half orange, right half grey, 16 x 8."""
    pixels = np.full((8, 16, 3), 90, np.uint8)
    pixels[:, :8] = (220, 120, 40)
    return pixels


def pack(pixels: Pixels, fourcc: str) -> bytes:
    """As a camera packs it, by ITU-R BT.601 with full range."""
    if fourcc in ("RGB3", "BGR3"):
        return bytes((pixels if fourcc == "RGB3" else pixels[:, :, ::-1]).tobytes())
    r, g, b = (pixels[:, :, each].astype(float) for each in range(3))
    y = 0.299 * r + 0.587 * g + 0.114 * b
    u, v = 128 + 0.564 * (b - y), 128 + 0.713 * (r - y)
    y, u, v = (np.clip(each.round(), 0, 255).astype(np.uint8) for each in (y, u, v))
    if fourcc == "GREY":
        return bytes(y.tobytes())
    if fourcc in ("YUYV", "UYVY"):
        cells = (y[:, 0::2], u[:, 0::2], y[:, 1::2], v[:, 0::2])
        order = (0, 1, 2, 3) if fourcc == "YUYV" else (1, 0, 3, 2)
        return bytes(np.stack([cells[each] for each in order], axis=2).tobytes())
    small_u, small_v = u[0::2, 0::2], v[0::2, 0::2]
    if fourcc == "NV12":
        return bytes(y.tobytes() + np.stack([small_u, small_v], axis=2).tobytes())
    return bytes(y.tobytes() + small_u.tobytes() + small_v.tobytes())


@pytest.mark.parametrize("fourcc", ["YUYV", "UYVY", "NV12", "YU12", "RGB3", "BGR3"])
def test_raw_format_is_unpacked_to_its_colours(fourcc: str) -> None:
    pixels = make_pixels()
    found = unpack_raw(pack(pixels, fourcc), fourcc, 16, 8, 0)
    assert found is not None
    assert np.abs(found.astype(int) - pixels).max() < 4


def test_grey_format_has_three_equal_colours() -> None:
    found = unpack_raw(pack(make_pixels(), "GREY"), "GREY", 16, 8, 0)
    assert found is not None
    assert found[0, 0].tolist() == [141, 141, 141]


def test_rows_may_be_longer_than_the_picture_is_wide() -> None:
    packed = np.frombuffer(pack(make_pixels(), "YUYV"), np.uint8).reshape(8, 32)
    padded = np.hstack([packed, np.full((8, 10), 255, np.uint8)])
    found = unpack_raw(padded.tobytes(), "YUYV", 16, 8, 42)
    assert found is not None
    assert np.abs(found.astype(int) - make_pixels()).max() < 4


@pytest.mark.parametrize("fourcc", ["YUYV", "NV12", "YU12", "RGB3", "GREY"])
def test_short_raw_picture_is_refused(fourcc: str) -> None:
    assert unpack_raw(pack(make_pixels(), fourcc)[:-1], fourcc, 16, 8, 0) is None


def test_nothing_is_chosen_where_no_format_can_be_used() -> None:
    assert choose_format([OfferedFormat("H264", (SizeRange((640, 480), (640, 480)),))], (640, 480)) is None
    assert choose_format([], (640, 480)) is None


def test_camera_that_lists_no_sizes_is_asked_for_the_wanted_one() -> None:
    assert choose_format([OfferedFormat("YUYV"), OfferedFormat("MJPG")], (640, 480)) == ("MJPG", (640, 480))


def test_jpeg_is_cut_after_its_end_and_refused_without_one() -> None:
    jpeg = make_jpeg()
    assert trim_jpeg(jpeg + b"\x00" * 9) == jpeg
    assert trim_jpeg(jpeg[:-2]) is None
    assert trim_jpeg(b"") is None


def test_encoded_picture_decodes_to_itself() -> None:
    assert np.abs(decode_jpeg(encode_jpeg(make_pixels(), 95)).astype(int) - make_pixels()).mean() < 4


def test_picture_is_mirrored_along_either_axis() -> None:
    pixels = np.arange(12, dtype=np.uint8).reshape(2, 2, 3)
    assert flip_pixels(pixels, horizontally=True, vertically=False)[0, 0].tolist() == [3, 4, 5]
    assert flip_pixels(pixels, horizontally=True, vertically=True)[0, 0].tolist() == [9, 10, 11]
