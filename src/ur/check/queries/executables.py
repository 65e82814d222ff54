"""Lookup of a node's program: installed, in the source tree, or built by the package."""

import re
from collections.abc import Iterator
from typing import Literal, NamedTuple

from ur.launchfile.world import World
from ur.launchfile.world.protocol import PackageNotFound

# catkin_add_executable_with_gtest, cuda_add_executable, add_rostest_gtest, catkin_add_gmock, ...
_TARGET = re.compile(r"(?<!\w)\w{0,60}add_\w{0,60}?(?:executable|gtest|gmock)\w{0,60}\s*\(\s*([^\s)]+)", re.IGNORECASE)
_OUTPUT = re.compile(r"OUTPUT_NAME\s+([^\s)]+)")
_SUBFOLDER = re.compile(r"add_subdirectory\s*\(\s*([\w./-]+)", re.IGNORECASE)
_PROJECT = re.compile(r"^\s*project\s*\(\s*([\w.-]+)", re.IGNORECASE | re.MULTILINE)
_VARIABLE = re.compile(r"\$\{[^}]{0,500}\}")
_DIGITS = re.compile(r"\d")
_MAX_DEPTH = 3
_SAME = 0.88
_SHORT = 5


class ExecutableLookup(NamedTuple):
    """Result of a lookup. `path` is the file that is not executable; `near` are programs with a similar name.

    `no-programs`: the package exists, but has neither programs nor files that declare how they are built.
    """

    kind: Literal["found", "unknown", "missing", "not-executable", "no-package", "no-programs"]
    path: str = ""
    near: tuple[str, ...] = ()


def find_program(package: str, name: str, world: World) -> ExecutableLookup:
    """Look up the program of a node. One that the package's build files declare counts as found."""
    if "/" in name:
        return ExecutableLookup("unknown")
    try:
        if world.find_executables(package, name):
            return ExecutableLookup("found")
        files = world.find_files(package, name)
        folder = world.find_package(package)
    except PackageNotFound:
        return ExecutableLookup("no-package")
    except (OSError, ValueError):
        return ExecutableLookup("unknown")
    if is_placeholder(folder, world):
        return ExecutableLookup("unknown")
    texts = list(_build_files(folder, world))
    if any(_builds(text, name) for text in texts):
        return ExecutableLookup("found")
    if files:
        return ExecutableLookup("not-executable", files[0])
    near = tuple(_programs_near(package, folder, texts, world))
    return ExecutableLookup("missing" if near or texts else "no-programs", near=near)


def is_placeholder(folder: str, world: World) -> bool:
    """Return whether a package's folder contains only package.xml: the package itself is installed elsewhere."""
    return set(world.list_folder(folder)) == {"package.xml"}


def is_misspelt(name: str, near: str) -> bool:
    """Return whether a name is so similar to an existing one that it is most likely misspelt."""
    if _DIGITS.sub("", name) == _DIGITS.sub("", near):
        return False  # openni_launch and openni2_launch are two packages
    if name.count("_") != near.count("_") and name.replace("_", "") != near.replace("_", ""):
        return False  # and so are robot_description and robot_description_gazebo
    if sorted(name) == sorted(near):
        return True
    if len(name) == len(near) and len(name) >= _SHORT:
        return sum(one != other for one, other in zip(name, near, strict=True)) <= 1 or _ratio(name, near) >= _SAME
    return _ratio(name, near) >= _SAME


def _ratio(name: str, near: str) -> float:
    from difflib import SequenceMatcher  # only needed once something is wrong

    return SequenceMatcher(None, name, near).ratio()


def _build_files(folder: str, world: World, depth: int = 0) -> Iterator[str]:
    for name in ("CMakeLists.txt", "setup.py"):
        try:
            text = world.read_bytes(f"{folder}/{name}").decode("utf-8", "replace")
        except OSError:
            continue
        yield text
        if depth < _MAX_DEPTH:
            for inner in _SUBFOLDER.findall(text):
                yield from _build_files(f"{folder}/{inner}", world, depth + 1)


def _builds(text: str, name: str) -> bool:
    # Also scripts that an install rule names: building makes them executable.
    if re.search(rf"(?<![\w.-]){re.escape(name)}(?![\w.-])", text):
        return True
    for target in _targets(text):
        if re.fullmatch(".*".join(re.escape(part) for part in _VARIABLE.split(target)), name):
            return True
    return False


def _targets(text: str) -> Iterator[str]:
    project = _PROJECT.search(text)
    for target in (*_TARGET.findall(text), *_OUTPUT.findall(text)):
        plain = target.strip('"')
        yield plain.replace("${PROJECT_NAME}", project.group(1)) if project else plain


def _programs_near(package: str, folder: str, texts: list[str], world: World) -> Iterator[str]:
    for text in texts:
        yield from (target for target in _targets(text) if "$" not in target)
    yield from world.executable_names(package)
    for place in (f"{folder}/bin", f"{folder}/scripts", f"{folder}/nodes"):
        yield from (name for name in world.list_folder(place) if world.is_file(f"{place}/{name}"))
