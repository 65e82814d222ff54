"""A world of plain dictionaries, for tests and for tools that ask "what if"."""

import posixpath
from collections.abc import Iterable, Mapping

from ur.launchfile.world.protocol import PackageNotFound


class MemoryWorld:
    """Files (path to text or bytes), packages (name to folder) and environment as values.

    `executables` are the paths of executable files. The working folder is `/`.
    """

    def __init__(
        self,
        files: Mapping[str, str | bytes],
        packages: Mapping[str, str] | None = None,
        environment: Mapping[str, str] | None = None,
        executables: Iterable[str] = (),
    ) -> None:
        self._files = {
            path: content.encode() if isinstance(content, str) else content for path, content in files.items()
        }
        self._packages = dict(packages or {})
        self._executables = frozenset(executables)
        self.environment: Mapping[str, str] = dict(environment or {})

    def find_package(self, name: str) -> str:
        if name not in self._packages:
            raise PackageNotFound(name)
        return self._packages[name]

    def package_names(self) -> Iterable[str]:
        return self._packages.keys()

    def find_in_package(self, package: str, path: str) -> str | None:  # noqa: ARG002 - World
        """See World. Nothing is installed outside of the package's folder."""
        self.find_package(package)
        return None

    def find_files(self, package: str, name: str) -> tuple[str, ...]:
        folder = self.find_package(package).rstrip("/") + "/"
        return tuple(path for path in self._files if path.startswith(folder) and posixpath.basename(path) == name)

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:
        return tuple(path for path in self.find_files(package, name) if path in self._executables)

    def executable_names(self, package: str) -> Iterable[str]:
        folder = self.find_package(package).rstrip("/") + "/"
        return {posixpath.basename(path) for path in self._executables if path.startswith(folder)}

    def is_file(self, path: str) -> bool:
        return self.absolute(path) in self._files

    def read_bytes(self, path: str) -> bytes:
        try:
            return self._files[self.absolute(path)]
        except KeyError:
            raise FileNotFoundError(2, "No such file or directory", path) from None

    def list_folder(self, path: str) -> tuple[str, ...]:
        folder = self.absolute(path).rstrip("/") + "/"
        return tuple(sorted({name[len(folder) :].split("/")[0] for name in self._files if name.startswith(folder)}))

    def absolute(self, path: str) -> str:
        return posixpath.normpath(posixpath.join("/", path))

    def make_anonymous(self, prefix: str) -> str:
        """See World. The name is always the same, for comparison in tests."""
        return f"{prefix}_memory_1"
