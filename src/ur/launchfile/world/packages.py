"""Finding packages as rospack does: rospkg's rules, without its cost.

Source of the rules: rospkg's `rospack.list_by_path` and `environment` as Debian ships them. The folders of
ROS_PACKAGE_PATH are walked, first match wins; below `/usr/share`, which Debian's rospkg appends, only one level.
"""

# Paths are texts here: pathlib would change what roslaunch prints, and costs too much in hot loops.
# ruff: noqa: PTH100, PTH116, PTH119, PTH123

from __future__ import annotations

import os
import re
from collections.abc import Mapping

SHARE = "/usr/share"
_NAME = re.compile(rb"<name>([^<&]*)</name>")


def package_paths(environment: Mapping[str, str]) -> list[str]:
    """The folders in which packages are searched, most important first."""
    paths = []
    root = environment.get("ROS_ROOT")
    if root:
        paths.append(os.path.normpath(root))
    paths.extend(
        path for path in (environment.get("ROS_PACKAGE_PATH", "") + ":" + SHARE).split(os.pathsep) if path.strip()
    )
    return paths


def find_packages(paths: list[str]) -> dict[str, str]:
    """Package name to folder, for folders given most important first.

    Raises ValueError with the file's name when a package.xml cannot be understood: rospack refuses to work then.
    """
    found: dict[str, str] = {}
    for path in reversed(paths):
        _walk(os.path.abspath(path), found)
    return found


def _walk(top: str, found: dict[str, str]) -> None:
    seen: set[str] = set()
    real: set[tuple[int, int]] = set()
    stack = [top]
    while stack:
        folder = stack.pop()
        if folder.startswith(SHARE + "/"):
            _visit_shared(folder, found, seen)
            continue
        files: set[str] = set()
        folders: list[str] = []
        try:
            with os.scandir(folder) as entries:
                for entry in entries:
                    try:
                        is_folder = entry.is_dir()
                    except OSError:
                        is_folder = False
                    if is_folder:
                        folders.append(entry.name)
                    else:
                        files.add(entry.name)
            identity = os.stat(folder)
        except OSError:
            continue
        if "CATKIN_IGNORE" in files:
            continue
        if _take(folder, "package.xml" in files, "manifest.xml" in files, found, seen) or "rospack_nosubdirs" in files:
            continue
        # A folder is entered through each of its links, as rospack does, but not below itself: that would not end.
        if (identity.st_dev, identity.st_ino) in real and folder.count("/") > 60:
            continue
        real.add((identity.st_dev, identity.st_ino))
        # rospkg removes hidden folders from the list it is iterating over, and so keeps every second one in a row.
        for name in folders:
            if name[0] == ".":
                folders.remove(name)
        stack.extend(folder + "/" + name if folder != "/" else "/" + name for name in reversed(folders))


def _visit_shared(folder: str, found: dict[str, str], seen: set[str]) -> None:
    has_package = os.path.lexists(folder + "/package.xml")
    has_manifest = not has_package and os.path.lexists(folder + "/manifest.xml")
    if (has_package or has_manifest) and not os.path.lexists(folder + "/CATKIN_IGNORE"):
        _take(folder, has_package, has_manifest or os.path.lexists(folder + "/manifest.xml"), found, seen)


def _take(folder: str, has_package: bool, has_manifest: bool, found: dict[str, str], seen: set[str]) -> bool:
    # Whether the folder is a package, a stack or a metapackage: nothing below it is looked at then.
    name: str | None = None
    if has_package:
        name = read_package_name(folder + "/package.xml")
    if name is None and has_manifest:
        name = os.path.basename(folder)
    if name is not None and name not in seen:
        seen.add(name)
        found[name] = folder
    return has_package or has_manifest


def read_package_name(path: str) -> str | None:
    """The name in a package.xml; None for a metapackage. Raises OSError, and ValueError when there is none."""
    with open(path, "rb") as file:
        data = file.read()
    if b"metapackage" not in data and b"<!--" not in data and b"<![CDATA[" not in data:
        names = _NAME.findall(data)
        if len(names) == 1 and names[0].isascii():
            text: str = names[0].decode("ascii")
            return text.strip(" \n\r\t")
    return _parse_package_name(path, data)


def _parse_package_name(path: str, data: bytes) -> str | None:
    from xml.etree import ElementTree  # rarely needed: most files are simple

    try:
        root = ElementTree.fromstring(data)  # noqa: S314 - expat limits what entities may grow to
    except (ElementTree.ParseError, ValueError, LookupError) as problem:
        raise ValueError(f"{path}: {problem}") from None
    if root.find("./export/metapackage") is not None:
        return None
    name = root.findtext("name")
    if name is None:
        raise ValueError(f"{path}: no <name>")
    return name.strip(" \n\r\t")
