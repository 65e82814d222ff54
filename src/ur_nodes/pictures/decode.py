"""Pictures as arrays, from JPEG and PNG, and from the bytes of a raw message. Pure: bytes in, arrays out."""

import io

import numpy as np
from numpy.typing import NDArray

from ur.source.foreign.pictures import open_picture
from ur_nodes.ports.values import Picture

Pixels = NDArray[np.uint8]
"""(rows, columns, 3), red, green, blue; rows from the top."""

_FORMATS = ("JPEG", "PNG")
_CHANNELS = {"rgb8": 3, "bgr8": 3, "mono8": 1, "8UC1": 1, "8UC3": 3, "rgba8": 4, "bgra8": 4}


class BadPictureError(ValueError):
    """The data is no picture, or one of an unknown kind. The text describes it."""


def decode_picture(data: bytes, smallest: tuple[int, int] | None = None) -> Pixels:
    """A JPEG or PNG. With `smallest` (columns, rows) a JPEG may come reduced, never below that: it costs much less.

    Raises BadPictureError.
    """
    try:
        with open_picture(io.BytesIO(data), _FORMATS) as picture:
            if smallest is not None:
                picture.draft("RGB", smallest)
            return np.asarray(picture.convert("RGB"), np.uint8)
    except (OSError, ValueError, SyntaxError, EOFError, LookupError, TypeError, OverflowError) as problem:
        raise BadPictureError(f"{len(data)} bytes that are neither JPEG nor PNG: {problem}") from None


def read_size(data: bytes) -> tuple[int, int]:
    """Columns and rows of a JPEG or PNG, without decoding it. Raises BadPictureError."""
    try:
        with open_picture(io.BytesIO(data), _FORMATS) as picture:
            columns, rows = picture.size
            return int(columns), int(rows)
    except (OSError, ValueError, SyntaxError, EOFError, LookupError, TypeError, OverflowError) as problem:
        raise BadPictureError(f"{len(data)} bytes that are neither JPEG nor PNG: {problem}") from None


def unpack_picture(data: bytes, width: int, height: int, step: int, encoding: str) -> Pixels:
    """The picture in a sensor_msgs/Image: `step` is the length of a row in bytes. Raises BadPictureError."""
    channels = _CHANNELS.get(encoding)
    if channels is None or not width or not height or step < width * channels or len(data) < step * height:
        raise BadPictureError(
            f"{len(data)} bytes, {width} x {height}, in encoding {encoding!r}; expected one of {', '.join(_CHANNELS)}"
        )
    rows = np.frombuffer(data, np.uint8, step * height).reshape(height, step)
    pixels = rows[:, : width * channels].reshape(height, width, channels)
    if channels == 1:
        return np.repeat(pixels, 3, axis=2)
    colours = pixels[:, :, :3]
    return np.ascontiguousarray(colours[:, :, ::-1] if encoding.startswith("bgr") else colours)


def make_picture(pixels: Pixels, stamp: int, frame: str) -> Picture:
    """The raw picture of pixels."""
    height, width = pixels.shape[:2]
    return Picture(stamp, frame, width, height, "rgb8", 3 * width, pixels.tobytes())


def fit_picture(pixels: Pixels, columns: int, rows: int) -> Pixels:
    """The whole picture in its proportions, as large as goes into a box; at least one pixel. Averages what it drops."""
    height, width = pixels.shape[:2]
    scale = min(columns / width, rows / height)
    size = max(1, round(width * scale)), max(1, round(height * scale))
    from PIL import Image  # 1 MB, which a node without a camera does without

    return np.asarray(Image.fromarray(pixels).resize(size, Image.Resampling.BOX), np.uint8)
