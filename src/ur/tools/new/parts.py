"""Requests for new files, and their writing: all of them or none, also when this process is killed."""

import os
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from pathlib import Path

from ur.source.diagnostic import user_error, user_error_about
from ur.source.foreign.files import read_file
from ur.source.replace import make_folder, replacing, sync_folder


@dataclass(frozen=True, slots=True)
class NewFile:
    """A file to write; `path` is relative to the package."""

    path: str
    text: str | bytes
    executable: bool = False


@dataclass(frozen=True, slots=True)
class NewArgument:
    """An `<arg>`: required if it has neither a default nor a value."""

    name: str
    doc: str
    default: str | None = None
    value: str | None = None


@dataclass(frozen=True, slots=True)
class NodeTopic:
    """A topic of a node: its name as the node writes it, its message type if known, and whether the node publishes."""

    name: str
    message: str = ""
    published: bool = False


@dataclass(frozen=True, slots=True)
class Observed:
    """The observed interface of a node: `services` without those of every node, `parameters` by name below the node.

    A parameter that the node requested and that is not set is None.
    """

    topics: tuple[NodeTopic, ...] = ()
    services: tuple[str, ...] = ()
    parameters: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class NodeRequest:
    """A launch directory `n_<name>` for one node."""

    name: str
    package: str
    type: str
    summary: str
    observed: Observed = field(default_factory=Observed)


@dataclass(frozen=True, slots=True)
class IncludedPart:
    """A launch file that another one includes: its `$(find)` path, and its arguments by name.

    `arguments` are their defaults, None for required ones; `docs` their comments.
    """

    file: str
    arguments: Mapping[str, str | None]
    docs: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class BaseRequest:
    """A new base: lengths in m, mass in kg, speeds in m/s and rad/s."""

    name: str
    summary: str
    length: float
    width: float
    height: float
    mass: float
    wheel_radius: float
    wheel_separation: float
    velocity: float
    angular_velocity: float
    lateral_velocity: float = 0.0
    lidar: bool = False
    raspicam: bool = False


def write_files(package: Path, files: Sequence[NewFile]) -> None:
    """Write files below a package. Raises UserError, without writing any, if one exists or cannot be written.

    A new package is complete or absent. In an existing one, the first file, which the others belong to, gets its name
    last; files that a killed command has left are taken if they are the same.
    """
    whole = package if package.exists() else package.with_name(f".{package.name}.{os.urandom(4).hex()}.ur-new")
    found = [file for file in files if os.path.lexists(package / file.path)]
    other = next((file for file in found if len(found) == len(files) or not _is_written(package, file)), None)
    if other is not None:
        message = f"{other.path} is there already, expected a new name"
        raise user_error(message, rule="file-exists", help=f"look at {package / other.path}", subject=other.path)
    paths = {file.path: whole / file.path for file in files if file not in found}
    above = {each for path in paths.values() for each in _missing_folders(path.parent)}
    try:
        with ExitStack() as stack:  # which ends with the first file
            for file in files:
                if file.path in paths:
                    make_folder(str(paths[file.path].parent))
                    out = stack.enter_context(replacing(paths[file.path], mode=0o775 if file.executable else 0o664))
                    out.write(_content(file))
        if whole != package:
            whole.rename(package)
            sync_folder(str(package.parent))
    except BaseException as problem:
        for path in paths.values():
            if path.is_file():
                path.unlink()
        for folder in sorted(above, reverse=True):
            with suppress(OSError):
                folder.rmdir()
        if isinstance(problem, OSError):
            reason = (problem.strerror or str(problem)).lower()
            raise user_error_about(problem.filename or package, f"{reason}", rule="unwritable-file") from None
        raise


def _content(file: NewFile) -> bytes:
    return file.text.encode() if isinstance(file.text, str) else file.text


def _is_written(package: Path, file: NewFile) -> bool:
    path = package / file.path
    return path.is_file() and not path.is_symlink() and read_file(path) == _content(file)


def _missing_folders(folder: Path) -> list[Path]:
    return [each for each in (folder, *folder.parents) if not each.exists()]
