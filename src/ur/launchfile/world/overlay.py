"""A world with texts laid over its files: unsaved ones of an editor, or those of a tentative change."""

import posixpath
from collections.abc import Callable, Iterable, Mapping

from ur.launchfile.world.protocol import World


def _same(path: str) -> str:
    return path


class OverlayWorld:
    """A world in which some files have other texts. `texts` are by absolute path, and may change.

    `follow` resolves a path with symbolic links, so that a text is found by each of its names.
    """

    def __init__(self, world: World, texts: Mapping[str, bytes], follow: Callable[[str], str] = _same) -> None:
        self._world = world
        self._texts = texts
        self._follow = follow

    @property
    def environment(self) -> Mapping[str, str]:
        return self._world.environment

    def find_package(self, name: str) -> str:
        return self._world.find_package(name)

    def package_names(self) -> Iterable[str]:
        return self._world.package_names()

    def find_in_package(self, package: str, path: str) -> str | None:
        return self._world.find_in_package(package, path)

    def find_files(self, package: str, name: str) -> tuple[str, ...]:
        found = self._world.find_files(package, name)
        folder = self._world.find_package(package).rstrip("/") + "/"
        new = (path for path in self._texts if path.startswith(folder) and posixpath.basename(path) == name)
        return (*found, *(path for path in new if path not in found))

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        return self._world.find_executables(package, name)

    def executable_names(self, package: str) -> Iterable[str]:
        return self._world.executable_names(package)

    def is_file(self, path: str) -> bool:
        return self._text_of(path) is not None or self._world.is_file(path)

    def read_bytes(self, path: str) -> bytes:
        text = self._text_of(path)
        return self._world.read_bytes(path) if text is None else text

    def list_folder(self, path: str) -> tuple[str, ...]:
        names = self._world.list_folder(path)
        folder = self._world.absolute(path).rstrip("/") + "/"
        new = {each[len(folder) :].split("/")[0] for each in self._texts if each.startswith(folder)}
        return names if new <= {*names} else tuple(sorted({*names, *new}))

    def absolute(self, path: str) -> str:
        return self._world.absolute(path)

    def make_anonymous(self, prefix: str) -> str:
        return self._world.make_anonymous(prefix)

    def _text_of(self, path: str) -> bytes | None:
        if not self._texts or not path:
            return None
        absolute = self._world.absolute(path)
        return self._texts[absolute] if absolute in self._texts else self._texts.get(self._follow(absolute))
