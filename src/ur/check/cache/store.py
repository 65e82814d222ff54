"""The file of a cache: one for each combination of targets, rules and arguments.

Two lines of JSON: a header with the format, a digest of the program and one of the second line, and the findings. A
file that cannot be read, or was written by another program, is ignored: the check then starts from nothing.
"""

import hashlib
import os
import stat
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib.util import find_spec
from typing import Annotated, NamedTuple
from xml.parsers import expat

from msgspec import Meta

from ur.check.cache.recall import KeptOutline, KnownFindings, Recall, RecalledFile, is_question
from ur.source.foreign.json_values import read_json_names, write_json_names
from ur.source.replace import PRIVATE, make_folder, replace_file
from ur.source.user_folders import user_folder

# ruff: noqa: PTH118, PTH123, PTH208


_PACKAGES = ("check", "launchfile", "source")  # all that takes part in a check


def digest_program() -> str:
    """Return a digest of the source of all involved modules, and of the versions of the parsers."""
    top = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))  # noqa: PTH100
    digest = hashlib.blake2b(digest_size=20)
    parser = os.path.dirname(str(getattr(find_spec("yaml"), "origin", "")))  # which takes time to import
    digest.update(
        repr((sys.version, parser, sorted({*os.listdir(parser)} - {"__pycache__"}), expat.EXPAT_VERSION)).encode()
    )
    sources = sorted(path for package in _PACKAGES for path in _sources(os.path.join(top, package)))
    for path in (f"{parser}/__init__.py", *sources):
        with open(path, "rb") as file:
            data = file.read()
        digest.update(f"\n{path.removeprefix(top)} {len(data)}\n".encode("utf-8", "surrogateescape"))
        digest.update(data)
    return digest.hexdigest()


def _sources(folder: str) -> list[str]:
    return [os.path.join(place, name) for place, _, names in os.walk(folder) for name in names if name.endswith(".py")]


# Exact paths and descriptors throughout.
# ruff: noqa: PTH123, PTH108, PTH120


FORMAT = 4
_SUFFIX = ".json"
_HEADER = 1000  # bytes at most


class CacheBounds(NamedTuple):
    """Limits of the cache: bytes of one file, and of all `files`, of which the last used ones stay; its `format`."""

    bytes: int = 64_000_000
    total: int = 256_000_000
    files: int = 64
    format: int = FORMAT


_BOUNDS = CacheBounds()


class _Header(NamedTuple):
    format: int
    program: str
    digest: str


class _Body(NamedTuple):
    """The content of the file. Each query is preceded by the digest of its answer."""

    questions: tuple[Annotated[tuple[str, ...], Meta(min_length=2)], ...]
    units: Mapping[str, RecalledFile]
    outlines: Mapping[str, KeptOutline]


def cache_folder(environment: Mapping[str, str]) -> str:
    """Return the folder of the files, below XDG_CACHE_HOME."""
    return f"{user_folder('XDG_CACHE_HOME', environment)}/ubiquity_launches/check"


def name_cache(places: Sequence[str], chosen: frozenset[str], arguments: Mapping[str, str]) -> str:
    """Return the name of the file for a check of absolute `places`."""
    what = repr((sorted(places), sorted(chosen), sorted(arguments.items())))
    return _digest(what.encode("utf-8", "backslashreplace"))[:32] + _SUFFIX


def load_recall(path: str, program: str, bounds: CacheBounds = _BOUNDS) -> Recall:
    """Load the findings of an earlier check by the same `program`; empty if no valid file exists."""
    try:
        header, _, text = _read(path, bounds).decode().partition("\n")
        expected = _Header(bounds.format, program, _digest(text.encode()))
        if read_json_names(header, _Header, _HEADER) != expected:
            raise ValueError("written by another program, or damaged")
        body = read_json_names(text, _Body, bounds.bytes)
        if not all(is_question(each[1:]) for each in body.questions):
            raise ValueError("not a question")
        count = len(body.questions)
        if any(number >= count for unit in body.units.values() for number in unit.questions):
            raise ValueError("not the questions of a file")
        return Recall(KnownFindings([(each[1:], each[0]) for each in body.questions], body.units, body.outlines))
    except (OSError, ValueError, RecursionError, MemoryError):  # a text that is nested too deep raises the third
        return Recall()


def store_recall(recall: Recall, path: str, program: str, bounds: CacheBounds = _BOUNDS) -> None:
    """Store the findings of a check for the next one.

    A simultaneous check replaces the file as a whole, or is replaced. If the file cannot be written, nothing happens:
    the next check takes longer, with the same findings.
    """
    with suppress(OSError):
        if not recall.changed and not recall.forgets:
            os.utime(path)
            return
    now = recall.now
    questions = tuple((digest, *question) for question, digest in now.questions)
    text = write_json_names(_Body(questions, now.units, now.outlines))
    header = write_json_names(_Header(bounds.format, program, _digest(text.encode())))
    if len(text) > bounds.bytes - _HEADER:
        return
    folder = os.path.dirname(path)
    with suppress(OSError):
        make_folder(folder, mode=0o700, lasting=False)
        replace_file(path, f"{header}\n{text}", mode=PRIVATE, follow=False, lasting=False)
        _remove_oldest(folder, bounds)


def _read(path: str, bounds: CacheBounds) -> bytes:
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOFOLLOW)
    with open(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_uid != os.geteuid() or status.st_size > bounds.bytes:
            raise ValueError(f"{path} is not a cache of this user")
        return file.read()


def _remove_oldest(folder: str, bounds: CacheBounds) -> None:
    with os.scandir(folder) as entries:
        files = [(entry.stat(follow_symlinks=False), entry.path) for entry in entries if entry.name.endswith(_SUFFIX)]
    files.sort(key=lambda pair: pair[0].st_mtime, reverse=True)
    total = 0
    for number, (status, path) in enumerate(files):
        total += status.st_size
        if number >= bounds.files or total > bounds.total:
            with suppress(OSError):
                os.unlink(path)


def _digest(data: bytes) -> str:
    return hashlib.blake2b(data, digest_size=20).hexdigest()
