"""Conversion of a launch file, and of all of a package."""

import fnmatch
import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ur.launchfile.syntax import parse_launch_file
from ur.launchfile.world import World
from ur.launchfile.world.protocol import PackageNotFound
from ur.source.diagnostic import Diagnostic, Severity, UserError, user_error_about
from ur.tools.convert.body import convert_launch
from ur.tools.convert.parameter_files import ParameterFile, convert_parameters
from ur.tools.convert.state import RULE, Findings
from ur.tools.convert.yaml_out import write_xml

HEAD = "<?xml version='1.0'?>\n"
_FIND = re.compile(r"\$\(find\s+([^()\s]+)\s*\)(.*)", re.DOTALL)
_COMPUTED = re.compile(r"\$\([^()]*\)")
_MOST_FILES = 1_000


@dataclass(frozen=True, slots=True)
class Converted:
    """A launch file for ROS 2, the files of parameters that it loads, and what could not be converted."""

    path: str
    text: str
    files: tuple[ParameterFile, ...]
    findings: tuple[Diagnostic, ...]


def convert_file(path: str, world: World) -> Converted:
    """Convert a launch file; `path` is absolute. Raises UserError for a file that cannot be read."""
    try:
        parsed = parse_launch_file(path, world.read_bytes(path), world.read_bytes)
    except OSError as problem:
        reason = f"{(problem.strerror or str(problem)).lower()}, expected a launch file"
        raise user_error_about(path, reason, rule="missing-file") from None
    if parsed.diagnostics or parsed.launch is None:
        raise UserError(*parsed.diagnostics)
    findings = Findings()
    tag = convert_launch(parsed.launch, parsed.comments, findings)
    files = tuple(_convert_files(findings, path, world))
    return Converted(path, HEAD + write_xml(tag), files, findings.finish())


def _convert_files(findings: Findings, path: str, world: World) -> Iterator[ParameterFile]:
    for written, substitutes in findings.files.items():
        found = find_files(written, path, world)
        if not found:
            message = f"{path}: no file of parameters found for {written}, expected one to convert"
            help_ = "convert it by hand: /** and ros__parameters above its values"
            findings.found.append(Diagnostic(Severity.WARNING, message, RULE, help=help_, subject=written))
        for each in found:
            try:
                text = world.read_bytes(each).decode("utf-8")
                yield ParameterFile(each, convert_parameters(text, substitutes))
            except (OSError, ValueError) as problem:  # noqa: PERF203 - the other files are converted
                findings.found.append(_bad_file(each, problem))


def find_files(written: str, path: str, world: World) -> Sequence[str]:
    """The files that a path in a launch file may name: any text stands for what an argument gives."""
    written = written.replace("$(dirname)", os.path.dirname(path))  # noqa: PTH120 - of a world, which may be no folder
    if found := _FIND.match(written):
        try:
            written = world.find_package(found[1]) + found[2]
        except (PackageNotFound, OSError, ValueError):
            return ()
    pattern = _COMPUTED.sub("*", written)
    if not pattern.startswith("/"):
        return ()
    folder, *names = pattern.strip("/").split("/")
    found_paths = [f"/{folder}"]
    for name in names:
        found_paths = [f"{each}/{entry}" for each in found_paths for entry in _entries(each, name, world)][:_MOST_FILES]
    return sorted(each for each in found_paths if world.is_file(each))


def _entries(folder: str, pattern: str, world: World) -> Sequence[str]:
    if "*" not in pattern:
        return (pattern,)
    return [name for name in world.list_folder(folder) if fnmatch.fnmatchcase(name, pattern)]


def _bad_file(path: str, problem: Exception) -> Diagnostic:
    message = f"{path}: {problem}, expected parameters"
    return Diagnostic(Severity.WARNING, message, RULE, help="ur check explains it", subject=path)
