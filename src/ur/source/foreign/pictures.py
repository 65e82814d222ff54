"""Untrusted picture files, opened within limits of format, pixels and unpacked size."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

from ur.source.foreign.files import open_file

if TYPE_CHECKING:
    from PIL import Image

MAX_PIXELS = 80_000_000  # a map of 440 m x 440 m at 0.05 m
MAX_UNPACKED = 2 * MAX_PIXELS  # bytes: pixels times channels times bytes of each
MAX_FILE = 256 * 1024 * 1024
# As map_server reads them with SDL_image. Pillow knows more, among them some that start a program (EPS).
MAP_FORMATS = ("PNG", "PPM", "BMP", "GIF", "JPEG", "TIFF", "TGA", "PCX", "WEBP")
_WIDE = {"I": 4, "F": 4, "I;16": 2, "I;16B": 2, "I;16L": 2, "I;16N": 2}  # bytes of a channel by Pillow's mode
_PLAIN_PNM = (b"P1", b"P2", b"P3")
_MAX_PLAIN = 32 * 1024 * 1024  # bytes
_MAX_COMMENTS = 100
_FEWEST_READS, _BYTES_A_READ = 20_000, 1000  # a picture in blocks of 8 kB takes three reads for each


@contextmanager
def open_picture(
    source: str | Path | IO[bytes], formats: Sequence[str], largest: int = MAX_PIXELS, *, inside: Path | None = None
) -> Iterator[Image.Image]:
    """Open a picture in one of these formats without decoding it; with `inside`, only below that folder.

    Raises OSError (PIL.UnidentifiedImageError for another format), or ValueError for one with more pixels than
    `largest` or more than MAX_UNPACKED bytes. Decoding a damaged picture raises OSError, ValueError or SyntaxError.
    """
    if isinstance(source, (str, Path)):
        with open_file(source, MAX_FILE, inside=inside) as file, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # about tags of TIFF, one a line
            with _opened(file, formats, largest) as image:
                yield image
    else:
        with _opened(source, formats, largest) as image:
            yield image


@contextmanager
def _opened(file: IO[bytes], formats: Sequence[str], largest: int) -> Iterator[Image.Image]:
    from PIL import Image

    # Pillow copies a block of a PNM in digits for each comment in it.
    head = file.read(2)
    if head in _PLAIN_PNM:
        data = file.read(_MAX_PLAIN + 1)
        if len(data) > _MAX_PLAIN or data.count(b"#") > _MAX_COMMENTS:
            limits = f"at most {_MAX_PLAIN:,} bytes and {_MAX_COMMENTS} comments"
            raise ValueError(f"a PNM in digits, expected one of bytes, or of {limits}")
    file.seek(0)
    try:
        with Image.open(cast("IO[bytes]", _Metered(file)), formats=list(formats)) as image:
            pixels = image.width * image.height
            if pixels > largest:
                raise ValueError(f"{image.width} x {image.height} pixels are too many, expected at most {largest:,}")
            size = pixels * len(image.getbands()) * _WIDE.get(image.mode, 1)
            if size > MAX_UNPACKED:
                shape = f"{image.width} x {image.height} pixels of {len(image.getbands())} channels"
                raise ValueError(f"{shape} take {size:,} bytes, expected at most {MAX_UNPACKED:,}")
            yield image
    except Image.DecompressionBombError as problem:
        raise ValueError(str(problem)) from None


class _Metered:
    """A file that raises an error if a library reads it in too many small pieces, as it does for comments and tags."""

    def __init__(self, file: IO[bytes]) -> None:
        self._file = file
        size = file.seek(0, os.SEEK_END)
        file.seek(0)
        self._left = _FEWEST_READS + size // _BYTES_A_READ

    def read(self, size: int = -1) -> bytes:
        self._left -= 1
        if self._left < 0:
            raise ValueError("too many comments, tags or blocks")
        return self._file.read(size)

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        return self._file.tell()
