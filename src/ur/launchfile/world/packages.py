"""Search for packages as rospack does: rospkg's rules, but faster.

Source of the rules: rospkg's `rospack.list_by_path` and `environment` as Debian ships them. The folders of
ROS_PACKAGE_PATH are walked, first match wins; below `/usr/share`, which Debian's rospkg appends, only one level.
"""

import os
import re
from collections.abc import Iterator, Mapping

from ur.source.diagnostic import UserError, error_about
from ur.source.foreign.files import MAX_MANIFEST, read_file


class BrokenPackageError(UserError, ValueError):
    """A package.xml is invalid, so that rospack refuses to search packages. Its text begins with the path."""


# Paths are texts here: pathlib would change what roslaunch prints, and costs too much in hot loops.
# ruff: noqa: PTH113, PTH114, PTH118, PTH119


_KERNEL = ("/proc/", "/sys/", "/dev/")


class FollowedLinks:
    """The targets of symbolic links in one walk."""

    def __init__(self) -> None:
        self._targets: set[str] = set()

    def leads_on(self, path: str, folder: str) -> bool:
        """Return whether a link in a folder leads to a folder that the walk does not reach otherwise.

        rospack also follows links to parent folders, until the system refuses, and finds the same packages again.
        """
        target, here = os.path.realpath(path), os.path.realpath(folder)
        if target in self._targets or f"{here}/".startswith(target.rstrip("/") + "/"):
            return False
        self._targets.add(target)
        return not f"{target}/".startswith(_KERNEL)


def walk_links(top: str) -> Iterator[tuple[str, list[str], list[str]]]:
    """Walk as `os.walk` with `followlinks`; the caller may change the lists of folders as there."""
    links = FollowedLinks()
    for folder, folders, files in os.walk(top, followlinks=True):
        folders[:] = [
            name
            for name in folders
            if not os.path.islink(path := os.path.join(folder, name)) or links.leads_on(path, folder)
        ]
        yield folder, folders, files


SHARE = "/usr/share"
_NAME = re.compile(rb"<name>([^<&]*)</name>")
_PROLOG = re.compile(rb"\s*(?:<\?xml[^<>]*\?>\s*)*")
_METAPACKAGE = re.compile(rb"<export>\s*<metapackage\s*/>\s*</export>\s*</package>\s*\Z")
_COMMENT = re.compile(rb"<!--[^-]*(?:-[^-]+)*-->")  # as XML has them: without -- inside


def package_paths(environment: Mapping[str, str]) -> list[str]:
    """Return the folders to search for packages, most important first; without ROS 1, not those of its packages."""
    paths = []
    if environment.get("ROS_VERSION") in ("0", "2"):
        return [path for path in environment.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if path.strip()]
    root = environment.get("ROS_ROOT")
    if root:
        paths.append(os.path.normpath(root))
    paths.extend(
        path for path in (environment.get("ROS_PACKAGE_PATH", "") + ":" + SHARE).split(os.pathsep) if path.strip()
    )
    return paths


def find_packages(paths: list[str]) -> dict[str, str]:
    """Return package folders by name, for search folders with the most important first.

    Raises ValueError with the file's name if a package.xml is invalid, since rospack then refuses to work.
    """
    found: dict[str, str] = {}
    for path in reversed(dict.fromkeys(map(os.path.abspath, paths))):  # a folder counts where it is named first
        _walk(path, found)
    return found


def _walk(top: str, found: dict[str, str]) -> None:
    seen: set[str] = set()
    links = FollowedLinks()
    stack = [top]
    while stack:
        folder = stack.pop()
        if folder.startswith(SHARE + "/"):
            if not _visit_package(folder, found, seen) and os.path.isfile(folder + "/manifest.xml"):
                name = os.path.basename(folder)
                if name not in seen and not os.path.isfile(folder + "/CATKIN_IGNORE"):
                    seen.add(name)
                    found[name] = folder
        elif not _visit_package(folder, found, seen):
            stack.extend(_folders_in(folder, found, seen, links))


def _visit_package(folder: str, found: dict[str, str], seen: set[str]) -> bool:
    # Whether the folder is a package: most that are looked at are, and listing them would only cost time.
    try:
        data = read_file(folder + "/package.xml", MAX_MANIFEST)
    except (FileNotFoundError, NotADirectoryError):
        return False
    except OSError as problem:
        if isinstance(problem, PermissionError) and not os.access(folder, os.X_OK):
            return False
        raise _broken(folder + "/package.xml", problem.strerror) from None
    # The first question costs less, where the answer is nearly always no.
    if os.access(folder + "/CATKIN_IGNORE", os.F_OK) and os.path.isfile(folder + "/CATKIN_IGNORE"):
        return True
    name = package_name_in(folder + "/package.xml", data)
    if name is None and os.path.isfile(folder + "/manifest.xml"):
        name = os.path.basename(folder)
    if name is not None and name not in seen:
        seen.add(name)
        found[name] = folder
    return True


def _folders_in(folder: str, found: dict[str, str], seen: set[str], links: FollowedLinks) -> list[str]:
    files: set[str] = set()
    folders: list[str] = []
    try:
        with os.scandir(folder) as entries:
            for entry in entries:
                if _is_folder(entry):
                    if not entry.is_symlink() or links.leads_on(entry.path, folder):
                        folders.append(entry.name)
                else:
                    files.add(entry.name)
    except OSError:
        return []
    if "CATKIN_IGNORE" in files:
        return []
    if "manifest.xml" in files:
        name = os.path.basename(folder)
        if name not in seen:
            seen.add(name)
            found[name] = folder
        return []
    if "rospack_nosubdirs" in files:
        return []
    # rospkg removes hidden folders from the list it is iterating over, and so keeps every second one in a row.
    for name in folders:
        if name[0] == ".":
            folders.remove(name)
    return [folder + "/" + name if folder != "/" else "/" + name for name in reversed(folders)]


def _is_folder(entry: os.DirEntry[str]) -> bool:
    try:
        return entry.is_dir()
    except OSError:
        return False


def read_package_name(path: str) -> str | None:
    """Return the name in a package.xml; None for a metapackage. Raises OSError, and ValueError without a name."""
    return package_name_in(path, read_file(path, MAX_MANIFEST))


def package_name_in(path: str, data: bytes) -> str | None:
    """Return the name as `read_package_name` does, from the content of the file."""
    simple, plain = False, data
    if b"<!" in data or b"metapackage" in data:
        # A processing instruction may hold what looks like a comment; the declaration does not, nor that of a schema.
        begin = _PROLOG.match(data)
        body = data[begin.end() :] if begin else data
        simple = b"<![CDATA[" not in body and b"<?" not in body
        plain = _COMMENT.sub(b"", body) if simple and b"<!--" in body else body
    if b"metapackage" not in plain and b"<!--" not in plain and b"<![CDATA[" not in plain:
        names = _NAME.findall(plain)
        if len(names) == 1 and names[0].isascii():
            text: str = names[0].decode("ascii")
            return text.strip(" \n\r\t")
    elif simple and b"<!--" not in plain and plain.count(b"<export>") == 1 and _METAPACKAGE.search(plain):
        return None
    from ur.source.foreign.xml_text import parse_xml  # rarely needed: most files are simple

    try:
        root = parse_xml(data)
    except ValueError as problem:
        raise _broken(path, problem) from None
    if root.find("./export/metapackage") is not None:
        return None
    name = root.findtext("name")
    if name is None:
        raise _broken(path, "no <name>")
    return name.strip(" \n\r\t")


def _broken(path: str, reason: object) -> ValueError:

    help_ = "correct this file, or take its folder out of ROS_PACKAGE_PATH"
    return BrokenPackageError(error_about(path, str(reason), rule="broken-package", help=help_))
