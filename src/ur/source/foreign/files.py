"""Untrusted files, opened within limits: regular files of a limited size, which never block.

This module imports little, since completion uses it for hundreds of files.
"""

# Descriptors and exact paths throughout.
# ruff: noqa: PTH116

from __future__ import annotations

import errno
import os
import stat
import sys

TYPE_CHECKING = False
if TYPE_CHECKING:  # as typing's, whose import takes time
    from typing import BinaryIO

    from ur.source.diagnostic import UserError

MAX_BYTES = 64 * 1024 * 1024
MAX_MANIFEST = 1024 * 1024  # bytes of a package.xml
_FLAGS = os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOCTTY
_BLOCK = 65536
PIPES = ("/dev/fd/", "/dev/stdin", "/proc/self/fd/")  # beginnings of paths that a shell makes of <(...)


def read_file(
    path: str | os.PathLike[str], limit: int = MAX_BYTES, *, inside: str | os.PathLike[str] | None = None
) -> bytes:
    """Return the content of a regular file of at most `limit` bytes.

    Links are followed; with `inside`, to files below that folder only. Raises OSError, which names the path, for a
    missing file, a pipe, device, socket or folder, a larger file, or one outside of the folder.
    """
    descriptor = open_descriptor(path, limit, inside=inside)
    try:
        return _read_all(descriptor, limit, os.fspath(path))
    finally:
        os.close(descriptor)


def read_text(
    path: str | os.PathLike[str],
    limit: int = MAX_BYTES,
    *,
    inside: str | os.PathLike[str] | None = None,
    errors: str = "replace",
) -> str:
    """Read a file as `read_file` does, as UTF-8 with universal line breaks.

    Raises ValueError if `errors` is "strict".
    """
    data = read_file(path, limit, inside=inside)
    return data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").decode("utf-8", errors)


def read_head(path: str | os.PathLike[str]) -> str:
    """Return the first 64 KiB of a regular file as text. Raises OSError as `read_file` does."""
    descriptor = open_descriptor(path, sys.maxsize)
    try:
        return os.read(descriptor, _BLOCK).replace(b"\r\n", b"\n").decode("utf-8", "replace")
    finally:
        os.close(descriptor)


def read_pipe(path: str, limit: int = MAX_BYTES) -> bytes:
    """Return the content of a pipe or file that the user has named on the command line; wait for its end."""
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC)
    try:
        return _read_all(descriptor, limit, path)
    finally:
        os.close(descriptor)


def open_file(
    path: str | os.PathLike[str], limit: int = MAX_BYTES, *, inside: str | os.PathLike[str] | None = None
) -> BinaryIO:
    """Open a file as `read_file` does, to be read in chunks: large meshes, pictures. The caller closes it.

    A file that grows after it was opened may have more than `limit` bytes.
    """
    return open(open_descriptor(path, limit, inside=inside), "rb")


def open_descriptor(
    path: str | os.PathLike[str], limit: int = MAX_BYTES, *, inside: str | os.PathLike[str] | None = None
) -> int:
    """Return a descriptor of a file, opened as `open_file` does."""
    name, flags = os.fspath(path), _FLAGS
    if "\0" in name:
        raise OSError(errno.EINVAL, "a path with a NUL character", name)
    if inside is not None:
        folder = os.fspath(inside)
        top, whole = os.path.realpath(folder), os.path.realpath(name)
        if whole != top and not whole.startswith(top.rstrip("/") + "/"):
            raise OSError(errno.EACCES, f"outside of the folder {folder}", name)
        name, flags = whole, flags | os.O_NOFOLLOW
    _check(os.stat(name), limit, name)  # first: opening alone starts some devices
    descriptor = os.open(name, flags)
    try:
        _check(os.fstat(descriptor), limit, name)
    except BaseException:
        os.close(descriptor)
        raise
    return descriptor


def refuse_file(path: str | os.PathLike[str], problem: OSError, expected: str, *, help: str | None = None) -> UserError:
    """Return the error for a file that cannot be read: path, reason, and `expected` ("a mesh of a robot")."""
    from ur.source.diagnostic import user_error_about

    reason = (problem.strerror or str(problem)).lower()
    return user_error_about(path, f"{reason}, expected {expected}", rule="unreadable-file", help=help)


def _check(status: os.stat_result, limit: int, name: str) -> None:
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "not a regular file", name)
    if status.st_size > limit:
        raise OSError(errno.EFBIG, f"larger than {limit:,} bytes", name)


def _read_all(descriptor: int, limit: int, name: str) -> bytes:
    # Files of /proc and /sys have no size, and any file may grow meanwhile: one byte more is asked for.
    size = os.fstat(descriptor).st_size
    data = os.read(descriptor, min(max(size + 1, _BLOCK), limit + 1))
    parts = [data]
    total = len(data)
    while data and size != total <= limit:
        data = os.read(descriptor, _BLOCK)
        parts.append(data)
        total += len(data)
    if total > limit:
        raise OSError(errno.EFBIG, f"larger than {limit:,} bytes", name)
    return b"".join(parts) if len(parts) > 2 else parts[0]
