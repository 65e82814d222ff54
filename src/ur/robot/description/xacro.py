"""Expansion of xacro files, by the xacro program: a library of this Python, or a command of this computer."""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur.source.file import SourceFile

# xacro's releases for ROS 2, which PyPI has, ask ament for `$(find PACKAGE)`; it is asked of us. A file
# that is included from a package that is not here is left out: many accessories are included and never used.
_SCRIPT = """
import io, json, sys, types
folders = json.load(sys.stdin)
missing = []
def find(name):
    if name not in folders:
        missing.append(name)
        raise LookupError(f"package {name!r} not found")
    return folders[name]
module = types.ModuleType("ament_index_python.packages")
module.get_package_share_directory = find
sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
sys.modules[module.__name__] = module
sys.path[:0] = sys.argv.pop(1).split(":") if sys.argv[1:2] else []
import xacro
import xacro.substitution_args
xacro.substitution_args._eval_find = find
included = getattr(xacro, "get_include_files", None)
def include(*words):
    before = len(missing)
    try:
        yield from included(*words)
    except Exception:
        if len(missing) == before:
            raise
if included:
    xacro.get_include_files = include
out, sys.stdout = sys.stdout, io.StringIO()
try:
    xacro.main()
finally:
    json.dump({"text": sys.stdout.getvalue(), "missing": missing}, out)
"""
_SECONDS = 60.0  # xacro files may call themselves without end


@dataclass(frozen=True, slots=True)
class DescriptionText:
    """The text of a URDF, and the packages that its xacro file includes files from and that are not here."""

    text: str
    missing: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Expander:
    """A command that expands a file; with `reports` it prints the fields of a DescriptionText."""

    command: tuple[str, ...]
    reports: bool


def read_description(
    path: Path,
    environment: Mapping[str, str],
    packages: Callable[[], Mapping[str, str]],
    arguments: Sequence[str] = (),
) -> DescriptionText:
    """Read a URDF file; a xacro file is expanded, with the defaults of all but the given arguments. Raises UserError.

    `packages` finds the folders of packages by name; it is called for xacro files only. `arguments` are NAME:=VALUE.
    """
    text = SourceFile.read(path, expected="a URDF or xacro file").text
    if uses_xacro(path, text):
        return _expand(path, environment, packages, arguments)
    if arguments:
        message = f"'{path}' is no xacro file, which takes no argument {arguments[0]!r}"
        raise UserError(error(message, rule="bad-value", help="leave it out", subject=arguments[0]))
    return DescriptionText(text)


def uses_xacro(path: Path, text: str) -> bool:
    """Return whether a file has to be expanded."""
    return path.suffix == ".xacro" or re.search(r"xmlns:xacro\s*=|<xacro:", text) is not None


def _find_xacro(environment: Mapping[str, str], packages: Mapping[str, str]) -> _Expander | None:
    python = (sys.executable, "-I", "-c", _SCRIPT)
    if importlib.util.find_spec("xacro") is not None:
        return _Expander((*python, ""), reports=True)
    program = shutil.which("xacro", path=environment.get("PATH"))
    folder = packages.get("xacro")
    if program is None and folder and Path(folder, "lib/xacro").is_dir():  # made by `ur get`
        return _Expander((*python, f"{folder}/lib"), reports=True)
    if program is None and folder:
        program = shutil.which("xacro", path=folder)
    return _Expander((program,), reports=False) if program else None


def _expand(
    path: Path,
    environment: Mapping[str, str],
    packages: Callable[[], Mapping[str, str]],
    arguments: Sequence[str],
) -> DescriptionText:
    known = dict(packages())
    expander = _find_xacro(environment, known)
    if expander is None:
        message = f"cannot expand '{path}': there is no xacro on this computer"
        help_ = "run 'ur get xacro', or give the URDF that xacro makes of it elsewhere"
        raise UserError(error(message, rule="no-xacro", help=help_, subject=str(path)))
    try:
        done = subprocess.run(
            [*expander.command, str(path), *arguments],
            env={**environment, "PYTHONSAFEPATH": "1"},  # the current folder holds no modules
            input=json.dumps(known).encode(),
            capture_output=True,
            check=False,
            timeout=_SECONDS,
        )
    except subprocess.TimeoutExpired:
        message = f"xacro did not finish with '{path}' within {_SECONDS:.0f} s"
        raise UserError(error(message, rule="bad-xacro", subject=str(path))) from None
    if done.returncode != 0:
        lines = done.stderr.decode(errors="replace").strip().splitlines()
        reason = re.sub(r"\x1b\[[0-9;]*m", "", lines[0] if lines else f"exit code {done.returncode}")
        message = f"xacro cannot expand '{path}': {reason[:300]}"
        gone = " ".join(_read_report(done.stdout).missing) if expander.reports else ""
        help_ = "source the setup.bash of the workspace that holds the packages it names"
        help_ = f"ur get {gone}, or {help_}" if gone else help_
        wanted = re.search(r"Undefined substitution argument (\w+)", reason)
        if wanted and wanted[1] not in [each.partition(":=")[0] for each in arguments]:
            help_ = f"its argument has no default: add {wanted[1]}:=VALUE to the command"
        raise UserError(error(message, rule="bad-xacro", help=help_, subject=str(path), reason=reason))
    if not expander.reports:
        return DescriptionText(done.stdout.decode(errors="replace"))
    return _read_report(done.stdout)


def _read_report(text: bytes) -> DescriptionText:
    try:
        fields = json.loads(text)
    except ValueError:
        return DescriptionText("")
    return DescriptionText(fields["text"], tuple(dict.fromkeys(fields["missing"])))
