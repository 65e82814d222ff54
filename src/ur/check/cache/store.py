"""The file of a cache: one for each combination of what is checked, with which rules and arguments.

Two lines of JSON: a header with the format, a digest of the program and one of the second line, and the findings.
A file that cannot be read, or was written by another program, is ignored: the check then finds everything again.
"""

# Exact paths and descriptors throughout.
# ruff: noqa: PTH123, PTH108, PTH120

from __future__ import annotations

import hashlib
import json
import os
import stat
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

from ur.check.cache.answers import is_question
from ur.check.cache.recall import KnownFindings, Recall, RecalledFile
from ur.source.replace import PRIVATE, make_folder, replace_file
from ur.source.user_folders import user_folder

FORMAT = 1
_SUFFIX = ".json"
_HEADER = 1000  # bytes at most


@dataclass(frozen=True, slots=True)
class CacheBounds:
    """Bytes of one file, and of all `files`, of which the ones that were used last stay; `format` of what is kept."""

    bytes: int = 64_000_000
    total: int = 256_000_000
    files: int = 64
    format: int = FORMAT


_BOUNDS = CacheBounds()


def cache_folder(environment: Mapping[str, str]) -> str:
    """The folder of the files, below XDG_CACHE_HOME."""
    return f"{user_folder('XDG_CACHE_HOME', environment)}/ubiquity_launches/check"


def name_cache(places: Sequence[str], chosen: frozenset[str], arguments: Mapping[str, str]) -> str:
    """The name of the file for a check of absolute `places`."""
    what = repr((sorted(places), sorted(chosen), sorted(arguments.items())))
    return _digest(what.encode("utf-8", "backslashreplace"))[:32] + _SUFFIX


def load_recall(path: str, program: str, bounds: CacheBounds = _BOUNDS) -> Recall:
    """Findings of an earlier check by the same `program`; none where there is no file that can be used."""
    try:
        return Recall(_read_known(_read(path, bounds), program, bounds))
    except (OSError, ValueError, RecursionError, MemoryError):  # a text that is nested too deep raises the third
        return Recall()


def store_recall(recall: Recall, path: str, program: str, bounds: CacheBounds = _BOUNDS) -> None:
    """Keep the findings of a check for the next one. One that runs beside this replaces the file whole, or is replaced.

    Does nothing where they cannot be written: the next check takes longer then, and finds the same.
    """
    with suppress(OSError):
        if not recall.changed and not recall.forgets:
            os.utime(path)
            return
    text = json.dumps(_body_of(recall.now), separators=(",", ":"))
    header = json.dumps({"format": bounds.format, "program": program, "digest": _digest(text.encode())})
    if len(text) > bounds.bytes - _HEADER:
        return
    folder = os.path.dirname(path)
    with suppress(OSError):
        make_folder(folder, mode=0o700, lasting=False)
        replace_file(path, f"{header}\n{text}", mode=PRIVATE, follow=False, lasting=False)
        _remove_oldest(folder, bounds)


def _body_of(known: KnownFindings) -> dict[str, object]:
    return {
        "questions": [[digest, *question] for question, digest in known.questions],
        "units": {path: [unit.inputs, list(unit.questions), unit.hits] for path, unit in known.units.items()},
    }


def _read(path: str, bounds: CacheBounds) -> bytes:
    descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK | os.O_NOFOLLOW)
    with open(descriptor, "rb") as file:
        status = os.fstat(descriptor)
        if not stat.S_ISREG(status.st_mode) or status.st_uid != os.geteuid() or status.st_size > bounds.bytes:
            raise ValueError(f"{path} is not a cache of this user")
        return file.read()


def _read_known(data: bytes, program: str, bounds: CacheBounds) -> KnownFindings:
    header, line_break, text = data.partition(b"\n")
    expected = {"format": bounds.format, "program": program, "digest": _digest(text)}
    if not line_break or len(header) > _HEADER or json.loads(header) != expected:
        raise ValueError("written by another program, or damaged")
    body = json.loads(text)
    if not isinstance(body, dict) or set(body) != {"questions", "units"} or not isinstance(body["questions"], list):
        raise ValueError("not the findings of a check")
    questions = []
    for each in body["questions"]:
        if not isinstance(each, list) or not each or not isinstance(each[0], str) or not is_question(each[1:]):
            raise ValueError("not a question")
        questions.append((tuple(each[1:]), each[0]))
    if not isinstance(body["units"], dict):
        raise ValueError("not the findings of a check")
    return KnownFindings(questions, {path: _read_unit(unit, len(questions)) for path, unit in body["units"].items()})


def _read_unit(value: object, questions: int) -> RecalledFile:
    if not isinstance(value, list) or len(value) != 3 or not isinstance(value[0], str):
        raise ValueError("not the findings of a file")
    inputs, numbers, hits = value
    if not isinstance(numbers, list) or not all(type(each) is int and 0 <= each < questions for each in numbers):
        raise ValueError("not the questions of a file")
    return RecalledFile(inputs, numbers, hits)  # hits are checked when they are decoded


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
