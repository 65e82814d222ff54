"""Candidates for completion, and the sources of names."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple


class Completion(NamedTuple):
    """A text to insert. `open` ones are incomplete: no blank follows (`speed:=`, `launch/`)."""

    text: str
    help: str = ""
    open: bool = False


class Line(NamedTuple):
    """A command line up to the cursor: complete arguments after `ur`, and the beginning of the present one.

    `raw` is that beginning as typed, with its quotes.
    """

    words: tuple[str, ...]
    prefix: str
    raw: str = ""


class Option(NamedTuple):
    """An option of a verb: its names, its description, whether a value follows, and the values if they are known."""

    names: tuple[str, ...]
    help: str
    takes_value: bool = False
    choices: tuple[str, ...] = ()


Source = Callable[[], Iterable[Completion]]


class NameSources(NamedTuple):
    """The sources of names, each called on demand.

    `sources` are by kind (`program`, `robot`, `run`, `node`, `base`, `selection`, `rule`, `verb`); `kinds` of
    arguments, and `options`, by verb; `launch_file` is the launch file that a program starts; `values` are those of an
    argument of a launch file; `names` are the names in a launch file with its arguments: parameters, arguments, remaps
    and nodes.
    """

    sources: Mapping[str, Source] = {}
    kinds: Callable[[str], Sequence[str]] = lambda _verb: ()
    options: Callable[[str], Sequence[Option]] = lambda _verb: ()
    launch_file: Callable[[str], str | None] = lambda _program: None
    values: Callable[[str, Mapping[str, str]], Iterable[Completion]] = lambda _name, _given: ()
    names: Callable[[str, Sequence[str]], Iterable[Completion]] = lambda _path, _words: ()
