"""Programs of nodes: their files, the modules that they run, and the files that may load a YAML file."""

import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass

from ur.launchfile.world import World
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.file import SourceFile
from ur.source.project import package_folder

_PIECE = re.compile(r"\$\([^)]{0,500}\)")
_MODULE = re.compile(r"^exec .*/lib/node\"? +(ur_nodes(?:\.\w+)+)", re.MULTILINE)
_LARGEST = 1_000_000  # bytes of a program


@dataclass(frozen=True, slots=True)
class NodeProgram:
    """A program as nodes name it: `pkg` and `type`."""

    package: str
    name: str


def program_files(program: NodeProgram, world: World) -> list[str]:
    """The files of a program: what is started, and the module that it runs where it only starts one."""
    with suppress(PackageNotFound, OSError, ValueError):
        found = world.find_executables(program.package, program.name)
        return list(dict.fromkeys(file for path in found for file in (path, *_module_of(path, world))))
    return []


def source_files(program: NodeProgram, world: World) -> list[str]:
    """The files in which a program may read its parameters: its own, and the modules beside the one that it runs."""
    files = program_files(program, world)
    for path in files[1:]:
        folder = path.rpartition("/")[0]
        beside = (f"{folder}/{name}" for name in world.list_folder(folder) if name.endswith(".py"))
        files += [each for each in beside if each not in files]
    return files


def _module_of(path: str, world: World) -> Iterator[str]:
    source = read_program(path, world)
    match = _MODULE.search(source.text) if source is not None else None
    if match is not None:
        module = f"{package_folder().parent}/{match[1].replace('.', '/')}.py"
        if world.is_file(module):
            yield module


def read_program(path: str, world: World) -> SourceFile | None:
    """The text of a program; None for what is no text, or a very long one."""
    with suppress(OSError):
        data = world.read_bytes(path)
        if b"\0" not in data[:1000] and len(data) <= _LARGEST:
            return SourceFile(path, data.decode("utf-8", "replace"))
    return None


def may_name(written: str, path: str) -> bool:
    """Return whether a value with `$(...)`, which may be anything, can be a path."""
    pieces = _PIECE.split(written.rpartition("../")[2])
    return any(pieces) and re.search(".*".join(map(re.escape, pieces)) + r"\Z", path) is not None
