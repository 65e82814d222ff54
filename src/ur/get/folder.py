"""Missing packages of a command line: of launch files, packages, and folders with all launch files below them."""

import os
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from ur.get.index import read_dependencies
from ur.get.missing import is_installed, missing_of_names, missing_of_plan, named_packages
from ur.get.steps import PACKAGE_NAME, Missing, Needs
from ur.launchfile.load import load_plan
from ur.launchfile.syntax.parse import count_unread, describe_unread
from ur.launchfile.world.system import SystemWorld
from ur.request.launch_request import make_request
from ur.source.arguments import split_argv
from ur.source.diagnostic import Severity, UserError, user_error
from ur.source.foreign.files import read_text
from ur.source.progress import Progress, no_progress


def find_needs(words: Sequence[str], environment: Mapping[str, str]) -> Needs:
    """Find the missing packages of a launch file with its arguments, of folders, or of packages. Raises UserError."""
    world = SystemWorld(environment)
    named = [word for word in words if ":=" not in word]
    if any(word.endswith(SUFFIXES) for word in named) or (len(named) == 1 and Path(named[0]).is_file()):
        return _file_needs(words, world)
    if len(named) != len(words):
        raise user_error("NAME:=VALUE is given, expected it after a launch file", rule="usage", help="ur get --help")
    found: dict[str, Missing] = {}
    notes: tuple[str, ...] = ()
    for word in words:
        if "/" in word or word in (".", ".."):
            needs = folder_needs([word], environment)
            world, notes = SystemWorld(with_folders([word], environment)), (*notes, *needs.notes)
            found.update((each.package, each) for each in needs.missing)
        elif not PACKAGE_NAME.fullmatch(word):
            message = f"{word!r} is neither a launch file nor the name of a package"
            raise user_error(message, rule="unknown-package", help="ur get --help")
        elif is_installed(word, world):
            text = text_of(Path(world.find_package(word)) / "package.xml")
            try:
                needed = missing_of_names(read_dependencies(text, environment), world)
                found.update((each.package, each) for each in needed)
            except ValueError as problem:
                notes = (*notes, f"the package.xml of {word} was not read: {problem}")
        else:
            found[word] = Missing(word)
    names = tuple(world.package_names())
    return Needs(tuple(found.values()), lambda name: is_installed(name, world), notes, names)


def _file_needs(words: Sequence[str], world: SystemWorld) -> Needs:
    request = make_request(split_argv(words), world)
    plan = load_plan(request.files.paths, [str(each) for each in request.arguments], world, parsed=request.files.parsed)
    others = [
        each for each in plan.diagnostics if each.severity is Severity.ERROR and each.rule not in
        ("unknown-package", "missing-executable")
    ]  # fmt: skip
    file = Path(request.files.paths[0]).resolve()
    unreadable = [each for each in others if each.rule in ("bad-xml", "wrong-ros-version")]
    if any(each.span and Path(each.span.file.path).resolve() == file for each in unreadable):
        raise UserError(*unreadable)
    notes = (f"not everything was read: {others[0].span or file}: {others[0].message}",) if others else ()
    missing = missing_of_plan(plan, world)
    names = tuple(world.package_names()) if missing else ()
    return Needs(missing, lambda name: is_installed(name, world), notes, names)


SUFFIXES = (".launch", ".launch.xml", ".test")
_TEXTS = (*SUFFIXES, ".xacro")
_MAX_TEXT = 4 * 1024 * 1024  # bytes
# Of a whole folder: a workspace of a thousand repositories stays below these.
_MAX_FILES = 20_000
_MAX_READ = 256 * 1024 * 1024  # bytes
_MAX_NAMES = 1000
_SKIPPED = frozenset({".git", ".hg", ".svn", "build", "devel", "node_modules"})


@dataclass(slots=True)
class _Found:
    """The data collected from the files of folders. `names`: the first file that names a package."""

    environment: Mapping[str, str]
    manifests: bool  # are read for names
    names: dict[str, Path] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    read: int = 0  # files that may name packages
    unread: Counter[str] = field(default_factory=Counter)  # files by kind


def folder_needs(
    folders: Sequence[str], environment: Mapping[str, str], progress: Progress = no_progress, *, manifests: bool = True
) -> Needs:
    """Find the packages that all launch files, xacro files and (`manifests`) package.xml below folders need.

    Raises UserError.

    Packages in the folders count as installed, since they are built there.
    """
    for folder in folders:
        if not Path(folder).is_dir():
            message = f"folder {folder!r} does not exist, expected one with launch files"
            raise user_error(message, rule="missing-file", help="ur get --missing FOLDER")
    found, world = _Found(environment, manifests), SystemWorld(with_folders(folders, environment))
    for folder in folders:
        _read_folder(folder, found, progress)
    unread = describe_unread(found.unread)
    if not found.read:
        message = f"no readable launch file, xacro file or package.xml in {', '.join(folders)}, expected one"
        raise user_error(message, rule="no-launch-files", help=unread or "ur get --missing FOLDER")
    if unread:
        found.notes.append(unread)
    places = {name: _shorten(path, folders) for name, path in found.names.items()}
    here = tuple(world.package_names())  # raises, where ROS refuses to search packages
    lacking = missing_of_names(places, world)
    if len(lacking) > _MAX_NAMES:
        found.notes.append(f"{len(lacking):,} packages are missing; the first {_MAX_NAMES:,} of them are looked for")
    return Needs(lacking[:_MAX_NAMES], lambda name: is_installed(name, world), tuple(found.notes), here)


def with_folders(folders: Sequence[str], environment: Mapping[str, str]) -> dict[str, str]:
    """Return an environment in which ROS also finds the packages of folders."""
    paths = [str(Path(folder).resolve()) for folder in folders]
    return {**environment, "ROS_PACKAGE_PATH": os.pathsep.join([*paths, environment.get("ROS_PACKAGE_PATH", "")])}


def text_of(path: Path) -> str:
    """Return the text of a file; "" if it cannot be read."""
    try:
        return read_text(path, _MAX_TEXT)
    except OSError:
        return ""


def _read_folder(folder: str, found: _Found, progress: Progress) -> None:
    characters = 0
    for count, path in enumerate(_list_texts(folder, found)):
        if count % 50 == 0:
            progress(f"{count} files read")
        if count == _MAX_FILES or characters > _MAX_READ:
            found.notes.append(f"only the first {count:,} files of {folder} were read")
            return
        characters += _read_file(path, found)


def _read_file(path: Path, found: _Found) -> int:
    # Returns the length of its text.
    text = text_of(path)
    names: Iterable[str] = ()
    if path.name == "package.xml":
        try:
            names = read_dependencies(text, found.environment) if found.manifests else ()
            found.read += 1
        except ValueError:
            found.unread["package.xml file with errors"] += 1
    else:
        names = named_packages(text)
        found.read += 1
    for name in names:
        found.names.setdefault(name, path)
    return len(text)


def _shorten(path: Path, folders: Sequence[str]) -> str:
    return next((str(path.relative_to(folder)) for folder in folders if path.is_relative_to(folder)), str(path))


def _list_texts(folder: str, found: _Found) -> Iterator[Path]:
    for place, below, files in os.walk(folder):
        found.unread.update(count_unread(files))
        below[:] = sorted(name for name in below if name not in _SKIPPED)
        for name in sorted(files):
            if name.endswith(_TEXTS) or name == "package.xml":
                yield Path(place, name)
