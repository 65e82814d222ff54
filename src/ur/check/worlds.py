"""The world of a check: an unknown value is a marker, not an error."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ur.launchfile.world import SystemWorld, World

_MAX_DEPTH = 6
_MAX_BESIDE = 20_000


def make_world(paths: Sequence[str], environment: Mapping[str, str]) -> SystemWorld:
    """Return this computer's world, in which the checked packages come first and those beside them last."""
    checked: dict[str, None] = {}
    beside: dict[str, None] = {}
    for path in map(Path, paths):
        place = path.absolute()
        enclosing = next((each for each in (place, *place.parents) if _is_package(each)), None)
        if enclosing is not None:
            checked[str(enclosing)] = None
            beside.update(dict.fromkeys(_beside(enclosing)))
        elif os.path.isdir(place):  # noqa: PTH112 - likewise
            checked.update(dict.fromkeys(_below(place)))
    known = [environment["ROS_PACKAGE_PATH"]] if environment.get("ROS_PACKAGE_PATH") else []
    joined = os.pathsep.join((*checked, *known, *(path for path in beside if path not in checked)))
    return SystemWorld({**environment, "ROS_PACKAGE_PATH": joined} if joined else environment)


def _is_package(folder: Path) -> bool:
    return os.path.isfile(folder / "package.xml")  # noqa: PTH113 - Path.is_file fails where a folder may not be read


def _beside(folder: Path) -> Iterator[str]:
    for each in _folders(folder.parent):
        if _is_package(each):
            yield str(each)


def _below(folder: Path, depth: int = 0) -> Iterator[str]:
    for each in _folders(folder):
        if _is_package(each):
            yield str(each)
        elif depth < _MAX_DEPTH:
            yield from _below(each, depth + 1)


def _folders(folder: Path) -> Iterable[Path]:
    try:
        found = [entry for entry in os.scandir(folder) if entry.is_dir() and not entry.name.startswith(".")]
    except OSError:
        return ()
    return [Path(entry.path) for entry in sorted(found, key=lambda entry: entry.name)[:_MAX_BESIDE]]


Question = tuple[str, ...]  # a method of World and its arguments
_REMEMBERED = frozenset(
    {
        *("find_package", "package_names", "find_in_package", "find_files", "find_executables", "executable_names"),
        *("is_file", "read_bytes", "list_folder"),
    }
)
QUESTIONS = _REMEMBERED | {"absolute"}
_EXPECTED = (LookupError, OSError, ValueError)  # PackageNotFound is the first

# A letter that no launch file uses, so that a marker is a legal name and is found again wherever it ends up.
_LETTER = "ǂ"
ANONYMOUS = "_anonymous"
_MARKER = re.compile(f"u{_LETTER}(\\d+){_LETTER}")


class Unknowns:
    """Values that are known only when a file is started: each has a unique marker, or a value to try."""

    def __init__(self) -> None:
        self._names: list[str] = []
        self.tried: dict[str, str] = {}
        self.defaults_used = False  # of environment variables that are not set

    def value_of(self, name: str) -> str:
        """Return the value to try for an unknown, otherwise its marker."""
        if name in self.tried:
            return self.tried[name]
        if name not in self._names:
            self._names.append(name)
        return f"u{_LETTER}{self._names.index(name)}{_LETTER}"

    @property
    def any_used(self) -> bool:
        """Return whether any unknown value was used."""
        return bool(self._names or self.tried)

    def names_in(self, text: str) -> list[str]:
        """Return the unknowns whose markers a text contains."""
        return [self._names[int(number)] for number in _MARKER.findall(text)]


def has_marker(text: str) -> bool:
    """Return whether a text depends on an unknown value."""
    return _LETTER in text


class Environment(dict[str, str]):
    """Environment variables; one that is not set is unknown, as it may be set on the computer that uses the file.

    With `no_defaults`, so is one with a default in the file: `$(optenv NAME DEFAULT)`. `note` is called with each name
    that is read.
    """

    def __init__(
        self,
        variables: Mapping[str, str],
        unknowns: Unknowns,
        *,
        no_defaults: bool = False,
        note: Callable[[str], None] | None = None,
    ) -> None:
        super().__init__(variables)
        self.pop("ROS_NAMESPACE", None)
        self._unknowns = unknowns
        self._no_defaults = no_defaults
        self._note = note or _forget

    def __getitem__(self, name: str) -> str:
        self._note(name)
        return super().__getitem__(name)

    def get(self, name: str, default: str | None = None) -> str | None:  # type: ignore[override]  # names are texts
        """See dict."""
        self._note(name)
        if name not in self and not name.startswith("ROS_"):
            if self._no_defaults:
                return self[name]
            self._unknowns.defaults_used = True
        return super().get(name, default)

    def __missing__(self, name: str) -> str:
        return self._unknowns.value_of(f"env {name}")


def _forget(name: str) -> None:
    pass


class _Raised(NamedTuple):
    problem: Exception


class CachedWorld:
    """A World that caches the answers of another one.

    Relative paths that are not found in the working folder are searched in `folder`. While `noted` is a set, all
    queries are added to it.
    """

    def __init__(self, world: World, environment: Mapping[str, str] | None = None, folder: str = "") -> None:
        self._world = world
        self._folder = folder
        self.environment: Mapping[str, str] = world.environment if environment is None else environment
        self._answers: dict[Question, object] = {}
        self._absolutes: dict[str, str] = {}
        self._notes = _Notes()

    @property
    def noted(self) -> set[Question] | None:
        """Return the set of recorded queries, shared by this world and those created by `seen_from`."""
        return self._notes.questions

    @noted.setter
    def noted(self, questions: set[Question] | None) -> None:
        self._notes.questions = questions

    def pause_by(self, pause: Callable[[], None] | None) -> None:
        """Call `pause` after each query that is recorded; it may wait, or end the work by an exception."""
        self._notes.pause = pause

    def note(self, *question: str) -> None:
        """Add a query to `noted` that another world answers."""
        if self._notes.questions is not None:
            self._notes.questions.add(question)
            if self._notes.pause is not None:
                self._notes.pause()

    def answer(self, question: Question) -> object:
        """Return the other world's answer to a recorded query, or the exception that it raises.

        The answer to `("environment", NAME)` is a variable, or None if it is not set.
        """
        kind, *words = question
        if kind == "environment":
            return self._world.environment.get(words[0])
        if kind not in QUESTIONS:
            raise ValueError(f"there is no question '{kind}'")
        try:
            return self._ask(*question) if kind in _REMEMBERED else getattr(self._world, kind)(*words)
        except _EXPECTED as problem:
            return problem

    def find_changes(self, path: str) -> set[Question] | None:
        """Return the queries about a file at an absolute path whose answers have changed; None without a query."""
        known = [question for question in _about_file(path) if question in self._answers]
        same = {each for each in known if _comparable(self._answers[each]) == _comparable(self._answer_now(each))}
        return {*known} - same if known else None

    def forget_file(self, path: str) -> Callable[[], None]:
        """Discard the answers about a file at an absolute path; return a function that restores them."""
        known = {each: self._answers.pop(each) for each in _about_file(path) if each in self._answers}
        return lambda: self._answers.update(known)

    def seen_from(self, folder: str, environment: Mapping[str, str]) -> CachedWorld:
        """Return the same world, with shared answers and records, with other variables and another folder."""
        other = CachedWorld(self._world, environment, folder)
        other._answers = self._answers
        other._absolutes = self._absolutes
        other._notes = self._notes
        return other

    def find_program(self, name: str) -> str:
        """Return the path of an installed program, by its name or path; `""` if there is none."""
        self.note("environment", "PATH")
        if "PATH" not in self.environment:
            return name  # as in a world of an example
        places = ("",) if "/" in name else self.environment["PATH"].split(":")
        return next(filter(self.is_file, (f"{place}/{name}".replace("//", "/") for place in places)), "")

    def locate(self, path: str) -> str:
        """Return the absolute path that a path refers to."""
        if not path or path.startswith("/") or not self._folder or self._ask("is_file", path):
            return self._absolute(path)
        beside = f"{self._folder}/{path}"
        return self._absolute(beside if self._ask("is_file", beside) else path)

    def find_package(self, name: str) -> str:
        return self._ask("find_package", name)  # type: ignore[no-any-return]  # the other world is typed

    def package_names(self) -> Iterable[str]:
        return self._ask("package_names")  # type: ignore[no-any-return]  # likewise

    def find_in_package(self, package: str, path: str) -> str | None:
        return self._ask("find_in_package", package, path)  # type: ignore[no-any-return]  # likewise

    def find_files(self, package: str, name: str) -> tuple[str, ...]:
        return self._ask("find_files", package, name)  # type: ignore[no-any-return]  # likewise

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        return self._ask("find_executables", package, name)  # type: ignore[no-any-return]  # likewise

    def executable_names(self, package: str) -> Iterable[str]:
        return self._ask("executable_names", package)  # type: ignore[no-any-return]  # likewise

    def is_file(self, path: str) -> bool:
        return bool(self._ask("is_file", self.locate(path) if path else path))

    def read_bytes(self, path: str) -> bytes:
        return self._ask("read_bytes", self.locate(path) if path else path)  # type: ignore[no-any-return]  # likewise

    def list_folder(self, path: str) -> tuple[str, ...]:
        names = self._list(path)
        if self._folder and not path.startswith("/"):
            beside = self._list(self._absolute(f"{self._folder}/{path}"))
            return tuple(sorted({*names, *beside}))
        return names

    def absolute(self, path: str) -> str:
        return self.locate(path) if path else self._absolute(path)

    def make_anonymous(self, prefix: str) -> str:
        """See World. The name is always the same, so that a check is reproducible."""
        return f"{prefix}{ANONYMOUS}"

    def _list(self, path: str) -> tuple[str, ...]:
        return self._ask("list_folder", path)  # type: ignore[no-any-return]  # likewise

    def _absolute(self, path: str) -> str:
        if not path.startswith("/"):
            self.note("absolute", path)
            return self._world.absolute(path)
        known = self._absolutes.get(path)  # which does not depend on the working folder
        if known is None:
            known = self._absolutes[path] = self._world.absolute(path)
        return known

    def _ask(self, *question: str) -> Any:
        self.note(*question)
        if question not in self._answers:
            self._answers[question] = self._answer_now(question)
        answer = self._answers[question]
        if isinstance(answer, _Raised):
            raise answer.problem.with_traceback(None)
        return answer

    def _answer_now(self, question: Question) -> object:
        kind, *words = question
        try:
            return getattr(self._world, kind)(*words)
        except _EXPECTED as problem:
            return _Raised(problem)


def _about_file(path: str) -> tuple[Question, Question]:
    return ("read_bytes", path), ("is_file", path)


def _comparable(answer: object) -> object:
    return repr(answer.problem) if isinstance(answer, _Raised) else answer


class _Notes:
    # One object for a world and those seen from it.
    questions: set[Question] | None = None
    pause: Callable[[], None] | None = None
