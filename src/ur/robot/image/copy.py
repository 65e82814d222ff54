"""Copies of images: decompressed, sparse, and renamed to their final path in one step."""

import bz2
import gzip
import lzma
import os
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, cast

from ur.robot.image.layout import identify_packing
from ur.source.diagnostic import UserError, user_error_about
from ur.source.replace import sync_folder

CHUNK = 1 << 20
_DAMAGE = (lzma.LZMAError, zlib.error, gzip.BadGzipFile, zipfile.BadZipFile, EOFError, ValueError, NotImplementedError)
_UNFINISHED = "ur-unfinished"
# Called with the number of bytes read, and of all bytes.
Progress = Callable[[int, int], None]


def packing_of(path: Path) -> str | None:
    """Identify the compression of a file; None for an uncompressed one. Raises UserError if it cannot be read."""
    try:
        with path.open("rb") as file:
            return identify_packing(file.read(8))
    except OSError as problem:
        raise _unusable(path, "read", problem) from None


@contextmanager
def copied_image(source: Path, target: Path, progress: Progress) -> Iterator[tuple[Path, Callable[[], None]]]:
    """Yield a decompressed copy of an image beside `target`, and a function that moves the complete copy to `target`.

    Only the user may read the copy, from its creation on, independent of the modes of `source` and `target`. If the
    function is not called, an error occurs or this process ends, `target` stays unchanged. Files of a killed process
    are removed by the next one. Raises UserError if the source is unreadable or damaged, or the disk is full.
    """
    for path in target.parent.glob(f".{target.name}.*.{_UNFINISHED}"):
        number = path.name.split(".")[-2]
        if not Path("/proc", number).exists():
            path.unlink(missing_ok=True)
    beside = target.with_name(f".{target.name}.{os.getpid()}.{_UNFINISHED}")

    def finish() -> None:
        with beside.open("rb") as file:
            os.fsync(file.fileno())
        os.replace(beside, target)  # noqa: PTH105 - what is left is a name, not the path that the caller was given
        sync_folder(str(target.parent))

    try:
        _copy(source, beside, progress)
        yield beside, finish
    finally:
        beside.unlink(missing_ok=True)


def _copy(source: Path, beside: Path, progress: Progress) -> None:
    try:
        with source.open("rb") as packed, open(beside, "xb", opener=_create_private) as copy:
            unpacked = _unpack(packed, source)
            total = os.fstat(packed.fileno()).st_size
            length = 0
            while chunk := unpacked.read(CHUNK):
                if chunk.count(0) == len(chunk):
                    copy.seek(len(chunk), os.SEEK_CUR)
                else:
                    copy.write(chunk)
                length += len(chunk)
                progress(os.lseek(packed.fileno(), 0, os.SEEK_CUR), total)
            copy.truncate(length)
    except _DAMAGE as problem:
        raise user_error_about(
            source, f"is damaged: {str(problem).lower()}", rule="damaged-image", help="download it again"
        ) from None
    except OSError as problem:
        raise _unusable(beside.parent, "written", problem) from None


def _create_private(path: str, flags: int) -> int:
    # The copy gets a private host key and password hashes, while its source was a public download.
    return os.open(path, flags, 0o600)


def _unpack(packed: IO[bytes], source: Path) -> IO[bytes]:
    kind = identify_packing(packed.read(8))
    packed.seek(0)
    if kind == "xz":
        return lzma.open(packed)
    if kind == "gzip":
        return cast("IO[bytes]", gzip.open(packed))
    if kind == "bzip2":
        return bz2.open(packed)
    if kind == "zip":
        archive = zipfile.ZipFile(packed)
        images = [name for name in archive.namelist() if name.endswith((".img", ".raw"))]
        if len(images) != 1:
            raise user_error_about(
                source,
                f"holds {len(images)} images, expected one file that ends in .img",
                rule="unknown-image",
                help="unpack it, then prepare its content",
            )
        return archive.open(images[0])
    if kind == "zstd":
        raise user_error_about(
            source,
            "is compressed with zstd, expected xz, gzip, bzip2, zip or none",
            rule="unknown-image",
            help=f"run: zstd -d {source}",
        )
    return packed


def _unusable(path: Path, doing: str, problem: OSError) -> UserError:
    reason = (problem.strerror or str(problem)).lower()
    return user_error_about(path, f"cannot be {doing}: {reason}", rule="unwritable-file")
