"""Picture files of other people, opened within limits: formats without programs behind them, and a number of pixels."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

if TYPE_CHECKING:
    from PIL import Image

MAX_PIXELS = 80_000_000  # a map of 440 m x 440 m at 0.05 m; its cells take some hundred MB while it is read
# As map_server reads them with SDL_image. Pillow knows more, among them some that start a program (EPS).
MAP_FORMATS = ("PNG", "PPM", "BMP", "GIF", "JPEG", "TIFF", "TGA", "PCX", "WEBP")


@contextmanager
def open_picture(
    source: str | Path | IO[bytes], formats: Sequence[str], largest: int = MAX_PIXELS
) -> Iterator[Image.Image]:
    """Open a picture in one of these formats without decoding it.

    Raises OSError (PIL.UnidentifiedImageError for another format), or ValueError for one with more pixels than
    `largest`. What decodes it raises OSError, ValueError or SyntaxError for a damaged one.
    """
    from PIL import Image

    try:
        with Image.open(source, formats=list(formats)) as image:
            if image.width * image.height > largest:
                raise ValueError(f"{image.width} x {image.height} pixels are too many, expected at most {largest:,}")
            yield image
    except Image.DecompressionBombError as problem:
        raise ValueError(str(problem)) from None
