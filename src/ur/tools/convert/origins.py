"""Packages and variables that stand for themselves while a Python launch file is read, so that its texts tell them.

Python computes paths when the file is read; XML and YAML name the package. A marked folder or variable goes through the
file's own operations on texts as a plain one does, and is found again in what they make.
"""

import re
from collections.abc import Callable, Iterator, Mapping

from ur.launchfile.ros2.model import Made
from ur.launchfile.world.overlay import OverlayWorld
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.file import Span

_SHARE, _VARIABLE, _DEFAULT, _END = "\ue000", "\ue001", "\ue002", "\ue003"
_MARKS = re.compile(
    f"/{_SHARE}([^/{_SHARE}]+)(/share/\\1(?![^/]))?|{_VARIABLE}([^{_VARIABLE}{_DEFAULT}{_END}]*)"
    f"(?:{_DEFAULT}([^{_VARIABLE}{_END}]*))?{_END}"
)


class _MarkedText(str):
    """The value of a variable that stands for itself. `on_test` is called when the file decides by it."""

    __slots__ = ("on_test",)
    on_test: Callable[[], None]

    def __eq__(self, other: object) -> bool:
        self.on_test()
        return str.__eq__(self, other)

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        self.on_test()
        return str.__hash__(self)

    def __bool__(self) -> bool:
        self.on_test()
        return True

    def _change(self, *_: object) -> "_MarkedText":
        self.on_test()
        return self

    lower = upper = strip = split = replace = startswith = endswith = _change  # type: ignore[assignment]


class MarkedVariables(dict[str, str]):
    """Environment variables whose values are their names.

    `used` are those that were read, True without a default; `tested` are those by which the file decides something
    while it is read.
    """

    def __init__(self) -> None:
        super().__init__()
        self.used: dict[str, bool] = {}
        self.tested: set[str] = set()

    def __missing__(self, name: str) -> str:
        return self.get(name)

    def get(self, key: str, default: object = None) -> str:
        """Return the mark of a variable, with its default."""
        self.used[key] = self.used.get(key, False) or default is None
        given = "" if default is None else f"{_DEFAULT}{default}"
        text = _MarkedText(f"{_VARIABLE}{key}{given}{_END}")
        text.on_test = lambda: self.tested.add(key)
        return text


class MarkedWorld(OverlayWorld):
    """A world whose packages are in marked folders. `contents` are the paths of read files, by their texts."""

    def __init__(self, world: World) -> None:
        super().__init__(world, {})
        self.variables = MarkedVariables()
        self.contents: dict[str, str] = {}

    @property
    def environment(self) -> Mapping[str, str]:
        return self.variables

    def find_package(self, name: str) -> str:
        return f"/{_SHARE}{name}/share/{name}"

    def is_file(self, path: str) -> bool:
        return self._world.is_file(self._real(path))

    def list_folder(self, path: str) -> tuple[str, ...]:
        return self._world.list_folder(self._real(path))

    def read_bytes(self, path: str) -> bytes:
        data = self._world.read_bytes(self._real(path))
        self.contents[data.decode(errors="replace").replace("\r\n", "\n")] = path
        return data

    def _real(self, path: str) -> str:
        def locate(found: re.Match[str]) -> str:
            if found[1] is None:
                return self._world.environment.get(found[3], found[4] or "")
            try:
                return self._world.find_package(found[1]) if found[2] else found[0]
            except (PackageNotFound, OSError, ValueError):
                return found[0]

        return _MARKS.sub(locate, path)

    def show(self, text: str) -> str:
        """Return a message with the names of packages and variables in the place of marks."""
        return _MARKS.sub(lambda found: found[1] or f"${found[3]}", text)

    def split(self, text: str, folder: str, span: Span) -> Iterator[str | Made]:
        """Yield the parts of a text: plain ones, and substitutions for marks, contents and the launch file's folder."""
        if len(text) > 40 and text in self.contents:
            yield Made("FileContent", {"path": [*self.split(self.contents[text], folder, span)]}, span)
            return
        if text == folder or text.startswith(f"{folder}/"):
            yield Made("ThisLaunchFileDir", {}, span)
            text = text[len(folder) :]
        place = 0
        for found in _MARKS.finditer(text):
            if found.start() > place:
                yield text[place : found.start()]
            yield _substitution(found, span)
            place = found.end()
        if text[place:] or not place:
            yield text[place:]


def _substitution(found: re.Match[str], span: Span) -> Made:
    package, share, variable, default = found.groups()
    if package is not None:
        return Made("FindPackageShare" if share else "FindPackagePrefix", {"package": package}, span)
    values = {"name": variable} if default is None else {"name": variable, "default_value": default}
    return Made("EnvironmentVariable", values, span)
