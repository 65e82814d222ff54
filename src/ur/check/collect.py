"""Collection of the files to check: all relevant files of a package or folder, or single files."""

import os
import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from ur.check.rule import BaseNames, EscapingLinks, Package
from ur.launchfile.address import join_addresses
from ur.launchfile.load import is_launch_name
from ur.launchfile.world import World
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.diagnostic import Diagnostic, UserError, error, error_about, user_error_about
from ur.source.file import SourceFile
from ur.source.suggest import did_you_mean

MAX_DEPTH = 30
_SKIPPED = frozenset({"node_modules", "__pycache__"})
_LAUNCH_SUFFIXES = (".launch", ".launch.xml", ".test")
_YAML_SUFFIXES = (".yaml", ".yml")
_ENTRY = b"\ndef generate_launch_description"
_TEST_ENTRY = b"generate_test_description"
_LAUNCH_DIRECTORY = re.compile(r"(n|m|rviz)_\w+\Z")
_NAME = re.compile(r"<name>\s*([^<\s]+)\s*</name>")
_DEPENDS = re.compile(r"<(?:\w*_)?depend\b[^>]*>\s*([^<\s]+)\s*</")


class Targets(NamedTuple):
    """The files to check, sorted, by kind; `whole`: packages that are checked completely.

    `left_out` are links that lead elsewhere, and unreadable folders; `found` are the files below each whole package,
    by its folder, whose names fit a launch file.
    """

    launch_files: tuple[str, ...]
    yaml_files: tuple[str, ...]
    programs: tuple[str, ...]
    packages: dict[str, Package]  # by folder
    whole: tuple[Package, ...]
    left_out: tuple[str, ...] = ()
    found: Mapping[str, Sequence[str]] = {}

    def package_of(self, path: str) -> Package | None:
        """Return the package that a file belongs to: the innermost folder with a package.xml."""
        folder = path
        while True:
            folder, _, last = folder.rpartition("/")
            if folder in self.packages:
                return self.packages[folder]
            if not last:
                return None


def collect_targets(paths: Sequence[str], world: World) -> Targets:
    """List the targets of a command line: paths of files and folders, packages, `PACKAGE FILE`.

    Raises UserError for any other argument.
    """
    launch: set[str] = set()
    yaml: set[str] = set()
    programs: set[str] = set()
    packages: dict[str, Package] = {}
    visited: set[str] = set()
    left_out: set[str] = set()
    found: dict[str, None] = {}
    for word in join_addresses(paths, world):
        path = _locate(word, world)
        links = EscapingLinks(path)
        files = [path] if world.is_file(path) else list(_walk(path, world, visited, links))
        left_out.update(links.left_out)
        found.update(dict.fromkeys(filter(_may_hold_launch_file, files)))
        _find_enclosing(path, world, packages)
        for file in files:
            if file.endswith("/package.xml"):
                _add_package(file.removesuffix("/package.xml"), world, packages)
        launch.update(file for file in files if _is_launch_file(file, file == path, world))
        yaml.update(file for file in files if file.endswith(_YAML_SUFFIXES) and not is_launch_name(file))
        folders = {f"{folder}/bin" for folder in packages}
        if world.is_file(path) and not _can_be_checked(path, launch, yaml, folders, world):
            raise user_error_about(
                word,
                "not a launch file, YAML file or program of a package",
                rule="unknown-file",
                help="a program is a file in the folder bin of a package, a launch file contains <launch>",
            )
        programs.update(file for file in files if file.rpartition("/")[0] in folders and is_script(file, world))
    programs = _without_twins(programs, world)
    whole = tuple(packages[folder] for folder in sorted(packages) if folder in visited)
    files_of = (tuple(sorted(launch)), tuple(sorted(yaml)), tuple(sorted(programs)))
    return Targets(*files_of, packages, whole, tuple(sorted(left_out)), _sort_by_package(found, whole))


def _sort_by_package(files: Iterable[str], packages: Iterable[Package]) -> Mapping[str, Sequence[str]]:
    found: dict[str, list[str]] = {package.folder: [] for package in packages}
    for file in files:
        folder = file
        while folder := folder.rpartition("/")[0]:
            if folder in found:
                found[folder].append(file)
    return found


def list_launch_files(folder: str, targets: Targets, world: World) -> list[str]:
    """Return the launch files below the folder of a package, with any suffix."""
    files = targets.found.get(folder)
    if files is None:
        files = list(filter(_may_hold_launch_file, _walk(folder, world, set(), EscapingLinks(folder))))
    return [path for path in files if _holds_launch_file(path, world)]


def may_be_checked(path: str) -> bool:
    """Return whether the name of a file shows that it may be checked, or may influence the check of others."""
    folder, _, name = path.rpartition("/")
    return (
        path.endswith((*_LAUNCH_SUFFIXES, ".xml", ".py", *_YAML_SUFFIXES))
        or folder.endswith("/bin")
        or "IGNORE" in name
    )


def _may_hold_launch_file(path: str) -> bool:
    return path.endswith((*_LAUNCH_SUFFIXES, ".xml")) and not path.endswith("/package.xml")


def _holds_launch_file(path: str, world: World) -> bool:
    try:
        return b"<launch" in world.read_bytes(path)
    except OSError:
        return False


def _can_be_checked(path: str, launch: set[str], yaml: set[str], folders: set[str], world: World) -> bool:
    return path in launch or path in yaml or (path.rpartition("/")[0] in folders and is_script(path, world))


def _without_twins(programs: set[str], world: World) -> set[str]:
    # A program may have a second name, a link: it is checked once, under its name with ur_.
    by_content: dict[bytes, str] = {}
    for path in sorted(programs, key=lambda path: (not path.rpartition("/")[2].startswith("ur_"), path)):
        by_content.setdefault(world.read_bytes(path), path)
    return set(by_content.values())


def is_script(path: str, world: World) -> bool:
    """Return whether a file begins with `#!`."""
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
    raise UserError(_explain_unusable(word, path, world))


def _explain_unusable(word: str, path: str, world: World) -> Diagnostic:
    if os.path.isdir(path):  # noqa: PTH112 - Path.is_dir fails where a folder may not be read
        if not os.access(path, os.R_OK | os.X_OK):
            message = f"{word}: the folder cannot be read: permission denied"
            return error(message, rule="unreadable-folder", help=f"ls -ld {shlex.quote(word)}")
        message = f"{word}: the folder is empty, expected launch files, YAML files or programs of a package"
        return error(message, rule="missing-file", help="'ur new package' makes a package with launch files")
    if os.path.lexists(path):
        message = f"{word}: neither a regular file nor a folder, expected a file, a folder or a package"
        return error(message, rule="missing-file", help=f"ls -l {shlex.quote(word)}")
    folder = path.rpartition("/")[0]
    above, slash, _ = word.rpartition("/")
    near = did_you_mean(word, {f"{above}{slash}{entry}" for entry in world.list_folder(folder)})
    if not near and not slash:
        near = did_you_mean(word, world.package_names())
    return error_about(
        word,
        "no such file, folder or package",
        rule="missing-file",
        help=f"did you mean {near}?" if near else f"'ls {shlex.quote(folder or '/')}' lists the files beside it",
    )


def _walk(
    folder: str,
    world: World,
    visited: set[str],
    links: EscapingLinks,
    above: tuple[tuple[str, ...], ...] = (),
    in_package: bool = False,
) -> Iterable[str]:
    visited.add(folder)
    names = world.list_folder(folder)
    if not names and os.path.isdir(folder) and not os.access(folder, os.R_OK | os.X_OK):  # noqa: PTH112 - texts here
        links.left_out.append(folder)
    # A folder that lists the same as one above it is that one, reached through a link.
    if len(above) > MAX_DEPTH or "CATKIN_IGNORE" in names or names in above:
        return
    in_package = in_package or "package.xml" in names
    for name in names:
        path = f"{folder.rstrip('/')}/{name}"
        if name.startswith(".") or name in _SKIPPED or links.leave_out(path, in_package=in_package):
            continue
        if world.is_file(path):
            yield path
        else:
            yield from _walk(path, world, visited, links, (*above, names), in_package)


def _is_launch_file(path: str, asked_for: bool, world: World) -> bool:
    if path.endswith(".py"):
        if "/bin/" in path or not (asked_for or path.endswith("launch.py") or "/launch/" in path):
            return False
        try:
            text = b"\n" + world.read_bytes(path)
            return asked_for or _ENTRY in text or (path.endswith(".launch.py") and _TEST_ENTRY not in text)
        except OSError:
            return True  # reported when it is read
    if is_launch_name(path):
        return True
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
        follows_conventions=_follows_conventions(folder, world),
        bases=tuple(_read_bases(folder, world)),
        depends=frozenset(_DEPENDS.findall(manifest)),
    )


def _follows_conventions(folder: str, world: World) -> bool:
    # At least one directory n_x, m_x or rviz_x that holds a launch file in its folder `launch`.
    for name in world.list_folder(folder):
        if _LAUNCH_DIRECTORY.match(name):
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
            from ur.source.section import parse_section  # with PyYAML, only where there is such a file

            whole = parse_section(SourceFile(path, text), "a base file")
            yield BaseNames(name, whole.section("variants").keys if whole.has("variants") else ())
        except (UserError, OSError):  # the file itself is reported as YAML
            yield BaseNames(name, ())
