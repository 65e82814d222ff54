"""Candidates for completion, and the sources of names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple


class Completion(NamedTuple):
    """Something to insert. `open` ones are not finished: no blank follows (`speed:=`, `launch/`)."""

    text: str
    help: str = ""
    open: bool = False


@dataclass(frozen=True, slots=True)
class Line:
    """A command line up to the cursor: finished words after `ur`, and the beginning of the one that is typed.

    `raw` is that beginning as it is typed, quotes and all.
    """

    words: tuple[str, ...]
    prefix: str
    raw: str = field(default="", compare=False)


class Option(NamedTuple):
    """An option of a verb: all its names, what it does, whether a value follows, and which ones if that is known."""

    names: tuple[str, ...]
    help: str
    takes_value: bool = False
    choices: tuple[str, ...] = ()


Source = Callable[[], Iterable[Completion]]


class NameSources(NamedTuple):
    """The sources of names; each is asked when it is needed.

    `sources` are by kind (`program`, `robot`, `run`, `node`, `base`, `selection`, `rule`, `verb`); `kinds` of
    arguments, and `options`, by verb; `launch_file` is the launch file that a program starts; `values` those that an
    argument of a launch file may have; `names` what a launch file with its arguments holds: parameters, arguments,
    remaps and nodes.
    """

    sources: Mapping[str, Source] = {}
    kinds: Callable[[str], Sequence[str]] = lambda _verb: ()
    options: Callable[[str], Sequence[Option]] = lambda _verb: ()
    launch_file: Callable[[str], str | None] = lambda _program: None
    values: Callable[[str, Mapping[str, str]], Iterable[Completion]] = lambda _name, _given: ()
    names: Callable[[str, Sequence[str]], Iterable[Completion]] = lambda _path, _words: ()
