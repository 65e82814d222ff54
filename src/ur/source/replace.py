"""Atomic replacement of files, also in case of a power cut. The only implementation for all packages.

Without `fsync`, a rename may reach the disk before the content of the file that it moves: after a power cut the file is
then empty. This module uses the standard library only and imports nothing that is slow to load.
"""

# Descriptors and exact paths throughout.
# ruff: noqa: PTH102, PTH105, PTH100, PTH108, PTH110, PTH112, PTH116, PTH118, PTH120, PTH121

from __future__ import annotations

import errno
import fcntl
import os
import stat
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress

TYPE_CHECKING = False
if TYPE_CHECKING:  # as typing's, whose import takes time
    from typing import BinaryIO

Sync = Callable[[int], object]
Begin = bytes | tuple[bytes, ...]
AnyPath = str | os.PathLike[str]
PUBLIC = 0o664  # of a new file, less the umask: never writable for everybody
PRIVATE = 0o600
_UNFINISHED = ".ur-new"
_ABANDONED = 60.0  # s


def replace_file(
    path: AnyPath,
    content: str | bytes,
    *,
    mode: int = PUBLIC,
    follow: bool = True,
    parents: bool = False,
    lasting: bool = True,
    sync: Sync = os.fsync,
) -> None:
    """Write a file completely or leave it unchanged. Raises OSError.

    A symbolic link stays one: its target is written. Without `follow`, for folders that another user can write to, the
    link is replaced by a file. The permissions of an existing file stay; `mode`, less the umask, is for new ones. With
    `parents`, missing folders are created. With `lasting`, the content is on the disk when this returns, which a cache
    does not need; `sync` is called for that with a descriptor.
    """
    with replacing(path, mode=mode, follow=follow, parents=parents, lasting=lasting, sync=sync) as file:
        file.write(content.encode("utf-8", "surrogateescape") if isinstance(content, str) else content)


@contextmanager
def replacing(
    path: AnyPath,
    *,
    mode: int = PUBLIC,
    follow: bool = True,
    parents: bool = False,
    lasting: bool = True,
    sync: Sync = os.fsync,
) -> Iterator[BinaryIO]:
    """Yield a file beside `path` that takes its place when the context ends without an error.

    The arguments are those of `replace_file`. Raises OSError.
    """
    folder, name = os.path.split(os.path.realpath(path) if follow else os.path.abspath(path))
    target = os.path.join(folder, name)
    if parents:
        make_folder(folder, lasting=lasting, sync=sync)
    permissions = _permissions(target)
    if lasting:
        _sweep(folder)
    beside = os.path.join(folder, f".{name[:200]}.{os.urandom(4).hex()}{_UNFINISHED}")
    # Exclusive: no existing link or file of this name is written to.
    try:
        descriptor = os.open(beside, os.O_RDWR | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, mode)
    except OSError as problem:
        problem.filename = path  # the name that the caller knows
        raise
    try:
        with open(descriptor, "wb") as file:  # noqa: PTH123 - a descriptor
            with suppress(OSError):
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)  # see _sweep
            if permissions is not None:
                os.fchmod(descriptor, permissions)
            yield file
            file.flush()
            if permissions is not None and permissions & (stat.S_ISUID | stat.S_ISGID):
                os.fchmod(descriptor, permissions)  # again: writing takes these two away from ordinary users
            if lasting:
                sync(descriptor)
        os.replace(beside, target)
    except BaseException:
        with suppress(OSError):
            os.unlink(beside)
        raise
    if lasting:
        sync_folder(folder, sync)


def _sweep(folder: str) -> None:
    """Remove the unfinished files of killed processes: those without a lock that are older than a minute."""
    with suppress(OSError), os.scandir(folder) as entries:
        for each in entries:
            if not (each.name.endswith(_UNFINISHED) and each.is_file(follow_symlinks=False)):
                continue
            with suppress(OSError):
                descriptor = os.open(each.path, os.O_WRONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
                try:
                    if os.fstat(descriptor).st_mtime < time.time() - _ABANDONED:
                        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                        os.unlink(each.path)
                finally:
                    os.close(descriptor)


def check_output(path: AnyPath, inputs: Iterable[AnyPath] = (), begin: Begin = b"") -> None:
    """Check a file that the user has named as an output, before anything is made for it.

    Raises UserError for one of the `inputs` under any name, for a folder, socket or disk, and for an existing file with
    content that does not begin with `begin`, or with one of several, as what replaces it will: it is of another kind.
    A stream, as a pipe, a terminal or /dev/null, may be written to.
    """
    from ur.source.diagnostic import UserError, user_error_about
    from ur.source.foreign.files import open_descriptor

    def refuse(message: str) -> UserError:
        return user_error_about(path, message, rule="existing-file", help="give the output another name")

    try:
        found = os.stat(path)
        if any(os.path.exists(each) and os.path.samefile(path, each) for each in inputs):
            raise refuse("is read for this output, expected another file")
        if _is_stream(found):
            return
        if begin and stat.S_ISREG(found.st_mode) and not found.st_size:
            return
        descriptor = open_descriptor(path, sys.maxsize)
        try:
            if not begin or not os.read(descriptor, 64).startswith(begin):
                raise refuse(f"is there already{', and of another kind' if begin else ''}, expected a new file")
        finally:
            os.close(descriptor)
    except FileNotFoundError:
        return
    except OSError as problem:
        raise refuse(f"{(problem.strerror or str(problem)).lower()}, expected a file that can be written") from None


@contextmanager
def output_file(
    path: AnyPath, inputs: Iterable[AnyPath] = (), begin: Begin = b"", *, mode: int = PUBLIC, parents: bool = False
) -> Iterator[BinaryIO]:
    """Open an output that the user has named: it passes `check_output`, and is complete or unchanged.

    A stream is written to as it is. Raises UserError.
    """
    from ur.source.diagnostic import user_error_about

    check_output(path, inputs, begin)
    try:
        is_stream = os.path.exists(path) and _is_stream(os.stat(path))
        with _open_stream(path) if is_stream else replacing(path, mode=mode, parents=parents) as file:
            yield file
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error_about(path, f"{reason}, expected a file that can be written", rule="unwritable-file") from None


def make_folder(folder: str, *, mode: int = 0o775, lasting: bool = True, sync: Sync = os.fsync) -> None:
    """Create a folder and its missing parents; `mode` is less the umask. Raises OSError."""
    if os.path.isdir(folder):
        return
    above = os.path.dirname(folder.rstrip("/")) or "."
    make_folder(above, mode=mode, lasting=lasting, sync=sync)
    try:
        os.mkdir(folder, mode)
    except FileExistsError:
        if not os.path.isdir(folder):
            raise
    if lasting:
        sync_folder(above, sync)


def sync_folder(folder: str, sync: Sync = os.fsync) -> None:
    """Sync the entries of a folder to the disk, so that created, renamed and removed files last. Raises OSError."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
    try:
        sync(descriptor)
    except OSError as problem:
        if problem.errno not in (errno.EINVAL, errno.ENOTSUP):  # some network file systems have no such thing
            raise
    finally:
        os.close(descriptor)


def _is_stream(status: os.stat_result) -> bool:
    return stat.S_ISCHR(status.st_mode) or stat.S_ISFIFO(status.st_mode)


def _open_stream(path: AnyPath) -> BinaryIO:
    """Open a stream; a pipe that no program reads raises OSError."""
    descriptor = os.open(path, os.O_WRONLY | os.O_NONBLOCK | os.O_NOCTTY | os.O_CLOEXEC)
    os.set_blocking(descriptor, True)
    return open(descriptor, "wb")  # noqa: PTH123 - a descriptor


def _permissions(target: str) -> int | None:
    try:
        status = os.lstat(target)
    except FileNotFoundError:
        return None
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), target)
    if stat.S_ISLNK(status.st_mode):
        return None
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "Not a regular file", target)
    return stat.S_IMODE(status.st_mode)
