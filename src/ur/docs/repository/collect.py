"""The contents of a launch repository: packages, bases, launch files and programs, each read once."""

import os
import posixpath
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass

from ur.check.collect import Targets, collect_targets, is_script
from ur.check.rule import BaseNames, LaunchView, Package, survey_launch_file
from ur.check.worlds import CachedWorld
from ur.docs.repository.bases import infer_bases
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, error, user_error
from ur.source.file import SourceFile, Span
from ur.source.progress import Progress, counted, no_progress

# A letter that no launch file uses, the marker of unknown values: findings that contain it are dropped.
_UNKNOWN = "ǂ"
_ELSEWHERE = f"/{_UNKNOWN}"


class RepositoryWorld:
    """Packages of the repository as they are; every other package has an imaginary folder. No environment variables."""

    def __init__(self, world: World, packages: Mapping[str, str]) -> None:
        self._world = world
        self._packages = dict(packages)
        self.environment: Mapping[str, str] = {}

    def find_package(self, name: str) -> str:
        """See World. Raises nothing."""
        return self._packages.get(name, f"{_ELSEWHERE}{name}")

    def package_names(self) -> Iterable[str]:
        return self._packages.keys()

    def find_in_package(self, package: str, path: str) -> str | None:  # noqa: ARG002 - World
        """See World. Installed files outside of the repository are ignored."""
        return None

    def find_files(self, package: str, name: str) -> tuple[str, ...]:  # noqa: ARG002 - World
        """See World. Not used here."""
        return ()

    def find_executables(self, package: str, name: str) -> tuple[str, ...]:  # noqa: ARG002 - World
        """See World. Not used here."""
        return ()

    def executable_names(self, package: str) -> Iterable[str]:  # noqa: ARG002 - World
        """See World. Not used here."""
        return ()

    def is_file(self, path: str) -> bool:
        """See World. A parameter file with an unknown path counts as existing."""
        return path.endswith((".yaml", ".yml")) if _UNKNOWN in path else self._world.is_file(path)

    def read_bytes(self, path: str) -> bytes:
        """See World.

        A file outside of the repository, or with an unknown path, counts as empty, so that its node is kept.
        """
        return b"{}" if _UNKNOWN in path else self._world.read_bytes(path)

    def list_folder(self, path: str) -> tuple[str, ...]:
        return () if _UNKNOWN in path else self._world.list_folder(path)

    def absolute(self, path: str) -> str:
        if path.startswith("/"):
            return path if "//" not in path and "/." not in path else posixpath.normpath(path)
        return self._world.absolute(path)

    def make_anonymous(self, prefix: str) -> str:
        """See World. The name is always the same."""
        return f"{prefix}_anonymous"


def is_elsewhere(path: str) -> bool:
    """Return whether a path is in a package that is not part of the repository."""
    return path.startswith(_ELSEWHERE)


def show_elsewhere(path: str) -> str:
    """Return such a path as written: `$(find package)/rest`."""
    package, slash, rest = path.removeprefix(_ELSEWHERE).partition("/")
    return f"$(find {package}){slash}{rest}"


def is_unknown(text: str) -> bool:
    """Return whether a text contains a value that depends on the user's input."""
    return _UNKNOWN in text


_DESCRIPTION = re.compile(r"<description[^>]{0,200}>(.*?)(?:</description>|\Z)", re.DOTALL)
_TAG = re.compile(r"<[^>]{0,500}>")


@dataclass(frozen=True, slots=True)
class RepositoryPart:
    """A package of the repository, or its files outside of packages."""

    package: Package
    is_package: bool
    description: str
    views: tuple[LaunchView, ...]
    programs: tuple[SourceFile, ...]


@dataclass(frozen=True, slots=True)
class DocumentedRepository:
    """All documented items, and the world in which they are resolved. `findings` are about unreadable files."""

    root: str
    parts: tuple[RepositoryPart, ...]
    views: Mapping[str, LaunchView]  # by absolute path
    trees: dict[str, LaunchFile]
    world: CachedWorld
    findings: tuple[Diagnostic, ...]
    left_out: tuple[str, ...] = ()  # links that lead out of it


def collect_repository(path: str, world: World, progress: Progress = no_progress) -> DocumentedRepository:
    """Read a package (by name or folder), a folder of packages, or any folder with launch files.

    Raises UserError if there is no such folder, or no launch file in it.
    """
    cached = CachedWorld(world)
    targets = collect_targets([path], cached)
    folder = cached.absolute(path)
    if cached.is_file(folder):
        message = f"{path} is a file, expected the folder or the package that it is in"
        raise user_error(message, rule="not-a-folder", help=f"ur docs {shlex.quote(_enclosing(folder, cached))}")
    root = folder if cached.list_folder(folder) else cached.absolute(cached.find_package(path))
    if not targets.launch_files:
        raise user_error(
            f"{path} holds no launch file, expected a launch repository: a package or a folder of packages",
            rule="no-launch-files",
            help="launch files end in .launch, .launch.xml, .launch.py or .launch.yaml",
            subject=path,
        )
    packages = _complete(targets, root, cached)
    targets = targets._replace(packages=packages)
    sealed = CachedWorld(RepositoryWorld(cached, {each.name: each.folder for each in reversed(packages.values())}))
    findings: list[Diagnostic] = []
    views = list(_read(targets, sealed, findings, progress))
    views = list(_with_bases(views, packages))
    parts = tuple(_make_parts(root, packages, targets, views, cached))
    return DocumentedRepository(
        root,
        parts,
        {view.path: view for view in views},
        {view.path: view.tree for view in views},
        sealed,
        tuple(findings),
        targets.left_out,
    )


def _enclosing(file: str, world: CachedWorld) -> str:
    # The package of a file, or the folder of a file that is in none, as seen from the current folder.
    beside = folder = file.rpartition("/")[0]
    while folder:
        if world.is_file(f"{folder}/package.xml"):
            return os.path.relpath(folder)
        folder = folder.rpartition("/")[0]
    return os.path.relpath(beside or "/")


def _complete(targets: Targets, root: str, world: CachedWorld) -> dict[str, Package]:
    # Files outside of every package count as a package of their own, called like the folder.
    packages = {folder: targets.packages[folder] for folder in sorted(targets.packages)}
    if any(targets.package_of(path) is None for path in targets.launch_files):
        bases = tuple(
            BaseNames(name, ())
            for name in world.list_folder(f"{root}/bases")
            if world.is_file(f"{root}/bases/{name}/base.yaml")
        )
        packages[root] = Package(root.rpartition("/")[2], root, False, bases, frozenset())
    return packages


def _read(targets: Targets, world: CachedWorld, findings: list[Diagnostic], progress: Progress) -> Iterator[LaunchView]:
    for path in counted(targets.launch_files, "reading", "launch files", progress):
        try:
            view = survey_launch_file(path, targets.package_of(path), world)
        except OSError as problem:
            reason = (problem.strerror or str(problem)).lower()
            place = Span(SourceFile(path, ""), 0, 0)
            findings.append(error(f"{path}: {reason}, expected a readable text", place, rule="unreadable-file"))
            continue
        findings.extend(() if view.tree.for_other_launcher else view.tree.diagnostics)
        yield view


def _with_bases(views: Iterable[LaunchView], packages: dict[str, Package]) -> Iterator[LaunchView]:
    # A package without bases of its own uses those of the repository; without any, what file names and values tell.
    views = list(views)
    everywhere: dict[str, BaseNames] = {}
    for package in packages.values():
        for base in package.bases:
            everywhere.setdefault(base.name, base)
    for folder, package in packages.items():
        if not package.bases:
            own = [view for view in views if view.package is not None and view.package.folder == folder]
            guessed = tuple(BaseNames(name, ()) for name in infer_bases(own))
            packages[folder] = package._replace(bases=tuple(everywhere.values()) or guessed)
    for view in views:
        package_ = packages[view.package.folder] if view.package is not None else None
        yield view._replace(package=package_)


def _make_parts(
    root: str, packages: Mapping[str, Package], targets: Targets, views: list[LaunchView], world: CachedWorld
) -> Iterator[RepositoryPart]:
    programs = {path for path in targets.programs if not path.endswith("/bin/ur")}
    if root in packages and not world.is_file(f"{root}/package.xml"):
        entries = (f"{root}/bin/{name}" for name in world.list_folder(f"{root}/bin"))
        programs |= {path for path in entries if world.is_file(path) and is_script(path, world)}
    for folder, package in packages.items():
        own = tuple(view for view in views if view.package is not None and view.package.folder == folder)
        sources = tuple(_read_programs(sorted(path for path in programs if path.startswith(f"{folder}/bin/")), world))
        if own or sources:
            manifest = f"{folder}/package.xml"
            is_package = world.is_file(manifest)
            yield RepositoryPart(package, is_package, _describe(manifest, world) if is_package else "", own, sources)


def _read_programs(paths: Iterable[str], world: CachedWorld) -> Iterator[SourceFile]:
    for path in paths:
        with suppress(OSError):
            yield SourceFile(path, world.read_bytes(path).decode("utf-8", "replace"))


def _describe(manifest: str, world: CachedWorld) -> str:
    try:
        found = _DESCRIPTION.search(world.read_bytes(manifest).decode("utf-8", "replace"))
    except OSError:
        return ""
    return " ".join(_TAG.sub(" ", found.group(1)).split()) if found else ""


def relative_path(path: str, root: str) -> str:
    """Return a path relative to the root of the repository."""
    return path[len(root) + 1 :] if path.startswith(root + "/") else posixpath.relpath(path, root)
