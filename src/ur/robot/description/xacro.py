"""Expansion of xacro files, by the xacro program: a library of this Python, or a command of this computer."""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur.source.file import SourceFile

# xacro's releases for ROS 2, which PyPI has, ask ament for `$(find PACKAGE)`; without ament it is asked of us.
_SCRIPT = """
import json, sys, types
folders = json.load(sys.stdin)
def find(name):
    if name not in folders:
        raise LookupError(f"package {name!r} not found")
    return folders[name]
try:
    import ament_index_python.packages
except ImportError:
    module = types.ModuleType("ament_index_python.packages")
    module.get_package_share_directory = find
    sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
    sys.modules[module.__name__] = module
import xacro
sys.exit(xacro.main())
"""
_SECONDS = 60.0  # xacro files may call themselves without end


def read_description(path: Path, environment: Mapping[str, str], packages: Callable[[], Mapping[str, str]]) -> str:
    """The URDF text of a file; a xacro file is expanded, with the defaults of its arguments. Raises UserError.

    `packages` finds the folders of packages by name; it is called for xacro files only.
    """
    text = SourceFile.read(path, expected="a URDF or xacro file").text
    if path.suffix == ".xacro" or re.search(r"xmlns:xacro\s*=|<xacro:", text):
        return _expand(path, environment, packages)
    return text


def _find_xacro(environment: Mapping[str, str], packages: Callable[[], Mapping[str, str]]) -> list[str] | None:
    if importlib.util.find_spec("xacro") is not None:
        return [sys.executable, "-I", "-c", _SCRIPT]
    program = shutil.which("xacro", path=environment.get("PATH"))
    if program is None and (folder := packages().get("xacro")):
        program = shutil.which("xacro", path=folder)
    return [program] if program else None


def _expand(path: Path, environment: Mapping[str, str], packages: Callable[[], Mapping[str, str]]) -> str:
    command = _find_xacro(environment, packages)
    if command is None:
        message = f"cannot expand '{path}': there is no xacro on this computer"
        help_ = "run 'ur get xacro', or give the URDF that xacro makes of it elsewhere"
        raise UserError(error(message, rule="no-xacro", help=help_, subject=str(path)))
    try:
        done = subprocess.run(
            [*command, str(path)],
            env={**environment, "PYTHONSAFEPATH": "1"},  # the current folder holds no modules
            input=json.dumps(dict(packages())).encode(),
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
        help_ = "source the setup.bash of the workspace that holds the packages it names"
        raise UserError(error(message, rule="bad-xacro", help=help_, subject=str(path), reason=reason))
    return done.stdout.decode(errors="replace")
