"""Missing packages of all launch files, xacro files and package.xml below folders."""

import os
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from pathlib import Path

from ur.get.hints import LISTS, TEXTS, is_of_family, join_hints, plain_address, read_hints, read_links
from ur.get.index import read_dependencies, read_name
from ur.get.missing import is_installed, missing_of_names, named_files, named_packages
from ur.get.owners import addresses_of, owners_above, owners_of_manifest, owners_of_repositories, read_owners
from ur.get.steps import Missing, Needs, SourceRepository
from ur.launchfile.syntax.parse import count_unread, describe_unread
from ur.launchfile.world.system import SystemWorld
from ur.source.diagnostic import UserError, error
from ur.source.foreign.files import read_text
from ur.source.progress import Progress, no_progress

_FEW = 3  # number of files; if there are fewer, all of them must exist
_SHARE = 0.8  # of more: some were removed since

SUFFIXES = (".launch", ".launch.xml", ".test")
_TEXTS = (*SUFFIXES, ".xacro")
_MAX_TEXT = 4 * 1024 * 1024  # bytes
# Of a whole folder: a workspace of a thousand repositories stays below these.
_MAX_FILES = 20_000
_MAX_READ = 256 * 1024 * 1024  # bytes
_MAX_NAMES = 1000
_MAX_HINTS = 1000
_MAX_PATHS = 100_000  # below packages, looked for under other names
_SKIPPED = frozenset({".git", ".hg", ".svn", "build", "devel", "node_modules"})


@dataclass(slots=True)
class _Found:
    """The data collected from the files of folders. `names`: the first file that names a package.

    `files`: paths below a package, each with the files that name it. `owners` are those of repositories and packages at
    folders; `packages`, the folders of package.xml; `own`, the folders of repositories by their plain addresses.
    """

    environment: Mapping[str, str]
    manifests: bool  # are read for names
    names: dict[str, Path] = field(default_factory=dict)
    files: dict[str, dict[str, set[Path]]] = field(default_factory=dict)
    hints: list[SourceRepository] = field(default_factory=list)
    links: list[SourceRepository] = field(default_factory=list)
    own: dict[str, Path] = field(default_factory=dict)
    owners: dict[Path, tuple[str, ...]] = field(default_factory=dict)
    packages: dict[str, Path] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    paths: int = 0
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
            raise UserError(error(message, rule="missing-file", help="ur get --missing FOLDER"))
    found, world = _Found(environment, manifests), SystemWorld(with_folders(folders, environment))
    for folder in folders:
        found.owners[Path(folder)] = owners_above(Path(folder).resolve())
        _read_folder(folder, found, progress)
    unread = describe_unread(found.unread)
    if not found.read:
        message = f"no readable launch file, xacro file or package.xml in {', '.join(folders)}, expected one"
        raise UserError(error(message, rule="no-launch-files", help=unread or "ur get --missing FOLDER"))
    if unread:
        found.notes.append(unread)
    places = {name: _shorten(path, folders) for name, path in found.names.items()}
    hints = join_hints(found.hints, found.links, found.own)[:_MAX_HINTS]
    here = tuple(world.package_names())  # raises, where ROS refuses to search packages
    lacking = missing_of_names(places, world)
    if len(lacking) > _MAX_NAMES:
        found.notes.append(f"{len(lacking):,} packages are missing; the first {_MAX_NAMES:,} of them are looked for")
    missing = tuple(_describe(each, found, world, folders) for each in lacking[:_MAX_NAMES])
    return Needs(missing, lambda name: is_installed(name, world), tuple(found.notes), hints, here)


def hints_above(path: Path) -> tuple[SourceRepository, ...]:
    """Return the repositories that a file names, and those that texts and lists beside it and in parent folders name.

    The search ends with the repository or package that contains the file.
    """
    hints: list[SourceRepository] = []
    links = [*read_links(text_of(path))]
    own: set[str] = set()
    for folder in path.parents:
        owner = next(iter(read_owners(folder)), "")
        for file in _files_of(folder):
            text = text_of(folder / file) if LISTS.fullmatch(file) or TEXTS.fullmatch(file) else ""
            hints += islice(read_hints(file, text, owner), _MAX_HINTS)
            links += read_links(text)
        if (folder / ".git").exists():
            own = {plain_address(url) for url in addresses_of(folder)}
            break
        if (folder / "package.xml").exists() and not any((each / ".git").exists() for each in folder.parents):
            break
    else:
        return tuple(dict.fromkeys(read_links(text_of(path))))
    return join_hints(hints, links, own)[:_MAX_HINTS]


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
        found.packages.setdefault(read_name(text), path.parent)
        found.links += read_links(text)
        found.owners[path.parent] = (*found.owners.get(path.parent, ()), *owners_of_manifest(text))
    elif path.name.endswith(_TEXTS):
        names = named_packages(text)
        found.read += 1
        found.links += read_links(text)
        for name, file in named_files(text):
            found.files.setdefault(name, {}).setdefault(file, set()).add(path)
    else:
        owner = next(iter(found.owners.get(path.parent, ())), "")
        found.hints += islice(read_hints(path.name, text, owner), _MAX_HINTS)
        found.links += read_links(text)
    for name in names:
        found.names.setdefault(name, path)
    return len(text)


def _describe(missing: Missing, found: _Found, world: SystemWorld, folders: Sequence[str]) -> Missing:
    # What only the folder knows of a package: who may have it, and whether it is here under another name or hidden.
    file = found.names[missing.package]
    owners = [owner for folder in file.parents for owner in found.owners.get(folder, ())]
    if hidden := found.packages.get(missing.package):
        return replace(missing, owners=tuple(dict.fromkeys(owners)), hidden=_shorten(hidden, folders))

    files = found.files.get(missing.package, {})

    def has_file(package: str, path: str) -> bool:
        found.paths += 1
        if found.paths > _MAX_PATHS:
            return False
        whole = found.packages[package] / path  # none that names this path: it would include itself
        return whole.exists() and whole not in files[path]

    here = [name for name in found.packages if name and is_installed(name, world)]
    renamed = find_renamed(missing.package, files, here, has_file)
    family = [each for each in found.links if is_of_family(missing.package, each)]
    others = tuple(each for each in owners_of_repositories([*family, *found.hints]) if each not in owners)
    itself = next((folder for url, folder in found.own.items() if url.endswith(f"/{missing.package.lower()}")), None)
    return replace(
        missing,
        owners=tuple(dict.fromkeys(owners)),
        renamed=renamed,
        others=others,
        itself=_shorten(itself, folders) if itself else "",
    )


def _files_of(folder: Path) -> list[str]:
    try:
        return sorted(each.name for each in os.scandir(folder) if each.is_file())
    except OSError:
        return []


def _shorten(path: Path, folders: Sequence[str]) -> str:
    return next((str(path.relative_to(folder)) for folder in folders if path.is_relative_to(folder)), str(path))


def _list_texts(folder: str, found: _Found) -> Iterator[Path]:
    for place, below, files in os.walk(folder):
        if ".git" in below or ".git" in files:
            found.owners[Path(place)] = read_owners(Path(place))
            found.own.update((plain_address(url), Path(place)) for url in addresses_of(Path(place)))
        found.unread.update(count_unread(files))
        below[:] = sorted(name for name in below if name not in _SKIPPED)
        for name in sorted(files):
            if name.endswith(_TEXTS) or name == "package.xml" or LISTS.fullmatch(name) or TEXTS.fullmatch(name):
                yield Path(place, name)


def find_renamed(
    package: str, paths: Collection[str], here: Iterable[str], has_file: Callable[[str, str], bool]
) -> str:
    """Find the only package that is `package` under another name; "" if there is none or several.

    Its name differs only in capitals and dashes, or it has the files that launch files expect in `package`: `paths`
    below the package's folder. `has_file` returns whether a package has a path.
    """
    names = tuple(here)
    if like := [name for name in names if _plain(name) == _plain(package)]:
        return like[0] if len(like) == 1 else ""
    least = len(paths) * (_SHARE if len(paths) >= _FEW else 1)
    fitting = [name for name in names if paths and sum(has_file(name, path) for path in paths) >= least]
    return fitting[0] if len(fitting) == 1 else ""


def _plain(name: str) -> str:
    return name.lower().replace("_", "").replace("-", "")
