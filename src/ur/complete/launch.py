"""Packages, launch files and their arguments."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from ur.complete.completions import Completion, NameSources
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.arguments import parse_argument, split_argv, values_of
from ur.source.diagnostic import UserError

if TYPE_CHECKING:
    from ur.launchfile.query.arguments import ArgumentSpec

_MAX_DEPTH = 6
_YAML = (".yaml", ".yml")


def complete_launch(words: Sequence[str], prefix: str, world: World, known: NameSources) -> Iterator[Completion]:
    """Yield candidates after `ur launch WORDS`: a package or file, a file of the package, then arguments."""
    plain = split_argv(words)[0]
    path, _ = find_address(plain, world)
    if path is not None:
        yield from complete_arguments(path, words, prefix, world, known)
    elif not plain:
        yield from complete_packages(prefix, world)
        yield from complete_paths(prefix, world)
    elif len(plain) == 1:
        yield from complete_files_of_package(plain[0], prefix, world)


def complete_packages(prefix: str, world: World) -> Iterator[Completion]:
    """Yield packages by name."""
    if "/" in prefix or prefix.startswith("."):
        return
    try:
        names = sorted(name for name in world.package_names() if name.startswith(prefix))
    except (OSError, ValueError):  # an unreadable package.xml: only this is not offered
        return
    yield from (Completion(name, "package") for name in names)


def complete_paths(prefix: str, world: World, *, every: bool = False) -> Iterator[Completion]:
    """Yield folders and launch files by path; `every`: all files. `.launch.xml` only if no `.launch` matches."""
    files: list[str] = []
    folder, slash, begin = prefix.rpartition("/")
    place = folder or ("/" if slash else ".")
    for name in world.list_folder(place):
        if not name.startswith(begin) or (name.startswith(".") and not begin):
            continue
        path = f"{folder}{slash}{name}"
        if not world.is_file(path):
            yield Completion(f"{path}/", "folder", open=True)
        elif every:
            yield Completion(path, "launch file" if ".launch" in name else "file")
        else:
            files.append(name)
    yield from (Completion(f"{folder}{slash}{name}", "launch file") for name in _choose_files(files, begin))


def _choose_files(names: Iterable[str], begin: str) -> list[str]:
    # People start *.launch. A *.launch.xml is for including, and is offered where nothing else fits.
    fitting = [name for name in names if name.startswith(begin)]
    started = [name for name in fitting if name.endswith(".launch")]
    parts = [name for name in fitting if name.endswith(".launch.xml")]
    return [*started, *parts] if ".launch." in begin else started or parts


def find_address(plain: Sequence[str], world: World) -> tuple[str | None, int]:
    """The launch file that words begin with, `FILE` or `PACKAGE FILE`, and how many words name it."""
    if len(plain) >= 2:
        try:
            found = world.find_files(plain[0], plain[1])
        except (PackageNotFound, OSError, ValueError):
            found = ()
        if found:
            return found[0], 2
    return (plain[0], 1) if plain and world.is_file(plain[0]) else (None, 0)


def complete_files_of_package(package: str, prefix: str, world: World) -> Iterator[Completion]:
    """Yield the launch files of a package by name; none if there is no such package."""
    try:
        top = world.find_package(package)
    except (PackageNotFound, OSError, ValueError):
        return
    names = _choose_files(sorted(set(_names_below(top, _MAX_DEPTH))), prefix)
    yield from (Completion(name, f"of {package}") for name in names)


def _names_below(folder: str, depth: int) -> Iterator[str]:
    try:
        entries = list(os.scandir(folder))
    except OSError:
        return
    for entry in entries:
        if entry.name.startswith("."):
            continue
        if entry.is_dir() and depth:
            yield from _names_below(entry.path, depth - 1)
        elif ".launch" in entry.name:
            yield entry.name


def complete_arguments(
    path: str, words: Sequence[str], prefix: str, world: World, known: NameSources
) -> Iterator[Completion]:
    """Yield the arguments of a launch file as `name:=` with their documentation, or their values after `name:=`."""
    given = values_of(split_argv(words)[1])
    begun = parse_argument(prefix)
    arguments = _read_arguments(path, words, world)
    if begun is None:
        for each in arguments:
            if each.name.startswith(prefix) and each.name not in given:
                default = "required" if each.default is None else f"default {each.default!r}"
                yield Completion(f"{each.name}:=", f"{_first_line(each.doc)} ({default})".strip(), open=True)
        return
    name, begin = begun.name, begun.value
    known_default = next((each.default for each in arguments if each.name == name), None)
    for value in _values(name, known_default, given, known):
        if value.text.startswith(begin):
            yield Completion(f"{name}:={value.text}", value.help)
    if name == "world" or name.endswith("_file"):
        for file in complete_paths(begin, world, every=True):
            if file.open or file.text.endswith(_YAML):
                yield Completion(f"{name}:={file.text}", file.help, file.open)


def _read_arguments(path: str, words: Sequence[str], world: World) -> tuple[ArgumentSpec, ...]:
    from ur.launchfile.query.arguments import read_arguments  # for every other word it would only cost time

    try:
        return read_arguments(path, list(words), world)
    except UserError as problem:
        # A default that rests on a required argument cannot be resolved before that one is given.
        missing = problem.diagnostics[0].subject
        guess = f"{missing}:=..." if missing else ""
        return _read_arguments(path, [*words, guess], world) if guess and guess not in words else ()


def _values(name: str, default: str | None, given: Mapping[str, str], known: NameSources) -> Iterable[Completion]:
    found = list(known.values(name, given))
    if not found and (default or "").lower() in ("true", "false"):
        return Completion("true"), Completion("false")
    return found


def _first_line(text: str) -> str:
    words = " ".join(text.replace("`", "").split())
    return words if len(words) <= 90 else words[:87].rsplit(" ", 1)[0] + " ..."
