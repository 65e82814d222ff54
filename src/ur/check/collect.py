"""Which files are checked: everything of a package or folder that rules look at, or single files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from ur.check.model import BaseNames, Package
from ur.launchfile.world import World
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.diagnostic import UserError, error
from ur.source.file import SourceFile
from ur.source.section import parse_section
from ur.source.suggest import did_you_mean

MAX_DEPTH = 30
_SKIPPED = frozenset({"node_modules", "__pycache__"})
_LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".test")
_YAML_SUFFIXES = (".yaml", ".yml")
_HOUSE_FOLDER = re.compile(r"(n|m|rviz)_\w+\Z")
_NAME = re.compile(r"<name>\s*([^<\s]+)\s*</name>")
_DEPENDS = re.compile(r"<(?:\w*_)?depend\b[^>]*>\s*([^<\s]+)\s*</")


@dataclass(frozen=True, slots=True)
class Targets:
    """The files to check, each once and sorted, by kind; `whole`: packages that are checked from end to end."""

    launch_files: tuple[str, ...]
    yaml_files: tuple[str, ...]
    programs: tuple[str, ...]
    packages: dict[str, Package]  # by folder
    whole: tuple[Package, ...]

    def package_of(self, path: str) -> Package | None:
        """The package that a file belongs to: the innermost folder with a package.xml."""
        folder = path
        while True:
            folder, _, last = folder.rpartition("/")
            if folder in self.packages:
                return self.packages[folder]
            if not last:
                return None


def collect_targets(paths: Sequence[str], world: World) -> Targets:
    """What to check for the words of a command line: paths of files and folders, or names of packages.

    Raises UserError for a word that is neither.
    """
    launch: set[str] = set()
    yaml: set[str] = set()
    programs: set[str] = set()
    packages: dict[str, Package] = {}
    visited: set[str] = set()
    for word in paths:
        path = _locate(word, world)
        files = [path] if world.is_file(path) else list(_walk(path, world, visited))
        _find_enclosing(path, world, packages)
        for file in files:
            if file.endswith("/package.xml"):
                _add_package(file.removesuffix("/package.xml"), world, packages)
        launch.update(file for file in files if _is_launch_file(file, file == path, world))
        yaml.update(file for file in files if file.endswith(_YAML_SUFFIXES))
        folders = {f"{folder}/bin" for folder in packages}
        if world.is_file(path) and not _can_be_checked(path, launch, yaml, folders, world):
            raise UserError(
                error(
                    f"{word} is no launch file, YAML file or program of a package, expected one of them",
                    rule="unknown-file",
                    help="programs stand in the folder bin of a package; launch files hold <launch>",
                )
            )
        programs.update(file for file in files if file.rpartition("/")[0] in folders and is_script(file, world))
    programs = _without_twins(programs, world)
    whole = tuple(packages[folder] for folder in sorted(packages) if folder in visited)
    return Targets(tuple(sorted(launch)), tuple(sorted(yaml)), tuple(sorted(programs)), packages, whole)


def _can_be_checked(path: str, launch: set[str], yaml: set[str], folders: set[str], world: World) -> bool:
    return path in launch or path in yaml or (path.rpartition("/")[0] in folders and is_script(path, world))


def _without_twins(programs: set[str], world: World) -> set[str]:
    # A program may have a second name, a link: it is checked once, under its name with ur_.
    by_content: dict[bytes, str] = {}
    for path in sorted(programs, key=lambda path: (not path.rpartition("/")[2].startswith("ur_"), path)):
        by_content.setdefault(world.read_bytes(path), path)
    return set(by_content.values())


def is_script(path: str, world: World) -> bool:
    """Whether a file begins with `#!`."""
    try:
        return world.read_bytes(path).startswith(b"#!")
    except OSError:
        return False


def _locate(word: str, world: World) -> str:
    path = world.absolute(word)
    if world.is_file(path) or world.list_folder(path):
        return path
    if "/" not in word:
        try:
            return world.absolute(world.find_package(word))
        except (PackageNotFound, OSError, ValueError):
            pass
    folder, _, name = path.rpartition("/")
    beside = {
        f"{word.rpartition('/')[0]}/{entry}".lstrip("/") if "/" in word else entry
        for entry in world.list_folder(folder)
    }
    near = did_you_mean(word, beside)
    raise UserError(
        error(
            f"{word}: no such file, folder or package, expected something to check",
            rule="missing-file",
            help=f"did you mean {near}?" if near else f"look into {folder or '/'}: there is no {name}",
        )
    )


def _walk(folder: str, world: World, visited: set[str], above: tuple[tuple[str, ...], ...] = ()) -> Iterable[str]:
    visited.add(folder)
    names = world.list_folder(folder)
    # A folder that lists the same as one above it is that one, reached through a link.
    if len(above) > MAX_DEPTH or "CATKIN_IGNORE" in names or names in above:
        return
    for name in names:
        if name.startswith(".") or name in _SKIPPED:
            continue
        path = f"{folder.rstrip('/')}/{name}"
        if world.is_file(path):
            yield path
        else:
            yield from _walk(path, world, visited, (*above, names))


def _is_launch_file(path: str, asked_for: bool, world: World) -> bool:
    if not asked_for and not path.endswith(_LAUNCH_SUFFIXES) and not (path.endswith(".xml") and "/launch/" in path):
        return False
    if (asked_for and path.endswith((*_YAML_SUFFIXES, "/package.xml"))) or ("/bin/" in path and is_script(path, world)):
        return False
    try:
        data = world.read_bytes(path)
    except OSError:
        return True  # reported when it is read
    if b"<launchConfiguration" in data[:500]:  # Eclipse has files of this name, too
        return False
    return path.endswith((".launch", ".launch.xml")) or b"<launch" in data


def _find_enclosing(path: str, world: World, packages: dict[str, Package]) -> None:
    folder = path
    while folder:
        if world.is_file(f"{folder}/package.xml"):
            _add_package(folder, world, packages)
            return
        folder = folder.rpartition("/")[0]


def _add_package(folder: str, world: World, packages: dict[str, Package]) -> None:
    if folder in packages:
        return
    try:
        manifest = world.read_bytes(f"{folder}/package.xml").decode("utf-8", "replace")
    except OSError:
        manifest = ""
    name = _NAME.search(manifest)
    packages[folder] = Package(
        name=name.group(1) if name else folder.rpartition("/")[2],
        folder=folder,
        house=_is_house(folder, world),
        bases=tuple(_read_bases(folder, world)),
        depends=frozenset(_DEPENDS.findall(manifest)),
    )


def _is_house(folder: str, world: World) -> bool:
    # At least one directory n_x, m_x or rviz_x that holds a launch file in its folder `launch`.
    for name in world.list_folder(folder):
        if _HOUSE_FOLDER.match(name):
            files = world.list_folder(f"{folder}/{name}/launch")
            if any(file.endswith((".launch", ".launch.xml")) for file in files):
                return True
    return False


def _read_bases(folder: str, world: World) -> Iterable[BaseNames]:
    for name in world.list_folder(f"{folder}/bases"):
        path = f"{folder}/bases/{name}/base.yaml"
        if not world.is_file(path):
            continue
        try:
            text = world.read_bytes(path).decode("utf-8", "replace")
            whole = parse_section(SourceFile(path, text), "a base file")
            yield BaseNames(name, whole.section("variants").keys if whole.has("variants") else ())
        except (UserError, OSError):  # the file itself is reported as YAML
            yield BaseNames(name, ())
