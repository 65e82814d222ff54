"""Pixel formats of cameras: the choice among those that one offers, and their conversion. Pure."""

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from PIL import Image

from ur_nodes.pictures.decode import Pixels, decode_picture

JPEG_FORMATS = ("MJPG", "JPEG")
RAW_FORMATS = ("YUYV", "UYVY", "NV12", "YU12", "RGB3", "BGR3", "GREY")  # the first ones are the cheaper ones
_BYTES = {"YUYV": 2.0, "UYVY": 2.0, "NV12": 1.5, "YU12": 1.5, "RGB3": 3.0, "BGR3": 3.0, "GREY": 1.0}  # of a pixel


@dataclass(frozen=True, slots=True)
class SizeRange:
    """Sizes of pictures that a camera offers in one format: from `smallest` to `largest`, or one if these are equal."""

    least: tuple[int, int]
    most: tuple[int, int]
    step: tuple[int, int] = (1, 1)

    def nearest(self, size: tuple[int, int]) -> tuple[int, int]:
        """Return the offered size that is nearest to `size`."""
        return _nearest(0, self, size), _nearest(1, self, size)


@dataclass(frozen=True, slots=True)
class OfferedFormat:
    """A pixel format with its sizes; none are known for a camera that does not list them."""

    fourcc: str
    sizes: tuple[SizeRange, ...] = ()


def choose_format(offered: Sequence[OfferedFormat], size: tuple[int, int]) -> tuple[str, tuple[int, int]] | None:
    """Choose format and size: the nearest size first, then JPEG before raw formats. None where none can be used."""
    best: tuple[tuple[float, int], str, tuple[int, int]] | None = None
    order = (*JPEG_FORMATS, *RAW_FORMATS)
    for each in offered:
        if each.fourcc not in order:
            continue
        for found in [sizes.nearest(size) for sizes in each.sizes] or [size]:
            distance = abs(found[0] - size[0]) / size[0] + abs(found[1] - size[1]) / size[1]
            rank = (round(distance, 6), order.index(each.fourcc))
            if best is None or rank < best[0]:
                best = (rank, each.fourcc, found)
    return (best[1], best[2]) if best else None


def unpack_raw(data: bytes, fourcc: str, width: int, height: int, step: int) -> Pixels | None:
    """Convert a raw picture to RGB; None if it is too short. `step` is the length of a row in bytes, or 0."""
    row = step or int(width * (1.0 if fourcc in ("NV12", "YU12") else _BYTES[fourcc]))
    rows = height * 3 // 2 if fourcc in ("NV12", "YU12") else height
    if len(data) < row * rows:
        return None
    packed = np.frombuffer(data, np.uint8, row * rows)
    if fourcc in ("RGB3", "BGR3"):
        pixels = packed.reshape(height, row)[:, : 3 * width].reshape(height, width, 3)
        return np.ascontiguousarray(pixels[:, :, ::-1] if fourcc == "BGR3" else pixels)
    if fourcc == "GREY":
        return np.repeat(packed.reshape(height, row, 1)[:, :width], 3, axis=2)
    planes = _planes(packed, fourcc, width, height, row)
    return np.asarray(Image.fromarray(np.stack(planes, axis=2), "YCbCr").convert("RGB"), np.uint8)


def encode_jpeg(pixels: Pixels, quality: int) -> bytes:
    """Encode a picture as JPEG, with a quality from 1 to 100."""
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "JPEG", quality=quality)
    return file.getvalue()


def decode_jpeg(data: bytes) -> Pixels:
    """Decode a JPEG. Raises BadPictureError."""
    return decode_picture(data)


def trim_jpeg(data: bytes) -> bytes | None:
    """Cut off the bytes that some cameras add after the end of a JPEG; None if it is incomplete."""
    if data[:2] != b"\xff\xd8":
        return None
    end = data.rfind(b"\xff\xd9")
    return data[: end + 2] if end > 0 else None


def flip_pixels(pixels: Pixels, *, horizontally: bool, vertically: bool) -> Pixels:
    """Mirror a picture."""
    return np.ascontiguousarray(pixels[:: -1 if vertically else 1, :: -1 if horizontally else 1])


def _nearest(axis: int, sizes: SizeRange, size: tuple[int, int]) -> int:
    least, most, step = sizes.least[axis], sizes.most[axis], max(1, sizes.step[axis])
    wanted = min(max(size[axis], least), most)
    return min(most, least + round((wanted - least) / step) * step)


def _planes(packed: Pixels, fourcc: str, width: int, height: int, row: int) -> list[Pixels]:
    """Return the planes of brightness and of two colours, each (height, width)."""
    if fourcc in ("YUYV", "UYVY"):
        cells = packed.reshape(height, row)[:, : 2 * width].reshape(height, width // 2, 4)
        y, u, v = ((0, 2), 1, 3) if fourcc == "YUYV" else ((1, 3), 0, 2)
        bright = np.stack([cells[:, :, y[0]], cells[:, :, y[1]]], axis=2).reshape(height, width)
        return [bright, np.repeat(cells[:, :, u], 2, axis=1), np.repeat(cells[:, :, v], 2, axis=1)]
    bright = packed[: row * height].reshape(height, row)[:, :width]
    rest = packed[row * height :]
    if fourcc == "NV12":
        both = rest.reshape(height // 2, row)[:, :width].reshape(height // 2, width // 2, 2)
        colours = [both[:, :, 0], both[:, :, 1]]
    else:
        quarter = row // 2 * (height // 2)
        colours = [rest[at : at + quarter].reshape(height // 2, row // 2)[:, : width // 2] for at in (0, quarter)]
    return [bright, *(np.repeat(np.repeat(each, 2, axis=0), 2, axis=1) for each in colours)]
