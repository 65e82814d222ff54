"""The world as a checker sees it: what is not known stands for itself instead of being an error."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping

from ur.launchfile.world import World

# A letter that no launch file uses, so that a marker is a legal name and is found again wherever it ends up.
_LETTER = "ǂ"
ANONYMOUS = "_anonymous"
_MARKER = re.compile(f"u{_LETTER}(\\d+){_LETTER}")


class Unknowns:
    """Values that only the person who starts a file knows: each has a marker that stands for it, or a value to try."""

    def __init__(self) -> None:
        self._names: list[str] = []
        self.tried: dict[str, str] = {}
        self.defaults_used = False  # of environment variables that are not set

    def value_of(self, name: str) -> str:
        """The value to try for an unknown, otherwise its marker."""
        if name in self.tried:
            return self.tried[name]
        if name not in self._names:
            self._names.append(name)
        return f"u{_LETTER}{self._names.index(name)}{_LETTER}"

    @property
    def any_used(self) -> bool:
        """Return whether anything unknown was asked for."""
        return bool(self._names or self.tried)

    def names_in(self, text: str) -> list[str]:
        """The unknowns whose markers a text holds."""
        return [self._names[int(number)] for number in _MARKER.findall(text)]


def has_marker(text: str) -> bool:
    """Return whether a text depends on something unknown."""
    return _LETTER in text


class Environment(dict[str, str]):
    """Environment variables; one that is not set here is unknown, as it may be set where the file is used.

    With `no_defaults`, so is one that has a default in the file: `$(optenv NAME DEFAULT)`.
    """

    def __init__(self, variables: Mapping[str, str], unknowns: Unknowns, *, no_defaults: bool = False) -> None:
        super().__init__(variables)
        self.pop("ROS_NAMESPACE", None)
        self._unknowns = unknowns
        self._no_defaults = no_defaults

    def get(self, name: str, default: str | None = None) -> str | None:  # type: ignore[override]  # names are texts
        """See dict."""
        if name not in self and not name.startswith("ROS_"):
            if self._no_defaults:
                return self[name]
            self._unknowns.defaults_used = True
        return super().get(name, default)

    def __missing__(self, name: str) -> str:
        return self._unknowns.value_of(f"env {name}")


class CachedWorld:
    """A World that asks another one each question once.

    Relative paths that are not found in the working folder are looked for in `folder`.
    """

    def __init__(self, world: World, environment: Mapping[str, str] | None = None, folder: str = "") -> None:
        self._world = world
        self._folder = folder
        self.environment: Mapping[str, str] = world.environment if environment is None else environment
        self._answers: dict[tuple[str, ...], object] = {}

    def seen_from(self, folder: str, environment: Mapping[str, str]) -> CachedWorld:
        """The same world, answers included, with other variables and another folder."""
        other = CachedWorld(self._world, environment, folder)
        other._answers = self._answers
        return other

    def locate(self, path: str) -> str:
        """The absolute path that a path stands for."""
        if not path or path.startswith("/") or not self._folder or self._is_file(path):
            return self._world.absolute(path)
        beside = f"{self._folder}/{path}"
        return self._world.absolute(beside if self._is_file(beside) else path)

    def find_package(self, name: str) -> str:
        """See World."""
        return self._world.find_package(name)

    def package_names(self) -> Iterable[str]:
        """See World."""
        return self._world.package_names()

    def find_in_package(self, package: str, path: str) -> str | None:
        """See World."""
        key = ("find_in_package", package, path)
        if key not in self._answers:
            self._answers[key] = self._world.find_in_package(package, path)
        return self._answers[key]  # type: ignore[return-value]  # put there above

    def find_files(self, package: str, name: str) -> tuple[str, ...]:
        """See World."""
        key = ("find_files", package, name)
        if key not in self._answers:
            self._answers[key] = self._world.find_files(package, name)
        return self._answers[key]  # type: ignore[return-value]  # put there above

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        """See World."""
        key = ("find_executables", package, name)
        if key not in self._answers:
            self._answers[key] = self._world.find_executables(package, name)
        return self._answers[key]  # type: ignore[return-value]  # put there above

    def executable_names(self, package: str) -> Iterable[str]:
        """See World."""
        return self._world.executable_names(package)

    def is_file(self, path: str) -> bool:
        """See World."""
        return self._is_file(self.locate(path) if path else path)

    def _is_file(self, path: str) -> bool:
        key = ("is_file", path)
        if key not in self._answers:
            self._answers[key] = self._world.is_file(path)
        return bool(self._answers[key])

    def read_bytes(self, path: str) -> bytes:
        """See World."""
        path = self.locate(path) if path else path
        key = ("read_bytes", path)
        if key not in self._answers:
            try:
                self._answers[key] = self._world.read_bytes(path)
            except OSError as problem:
                self._answers[key] = problem
        answer = self._answers[key]
        if isinstance(answer, OSError):
            raise answer
        return answer  # type: ignore[return-value]  # put there above

    def list_folder(self, path: str) -> tuple[str, ...]:
        """See World."""
        names = self._world.list_folder(path)
        if self._folder and not path.startswith("/"):
            beside = self._world.list_folder(self._world.absolute(f"{self._folder}/{path}"))
            return tuple(sorted({*names, *beside}))
        return names

    def absolute(self, path: str) -> str:
        """See World."""
        return self.locate(path) if path else self._world.absolute(path)

    def make_anonymous(self, prefix: str) -> str:
        """See World. The same name each time: a check says the same each time."""
        return f"{prefix}{ANONYMOUS}"
