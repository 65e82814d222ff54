"""Types of messages and services for which Python code is installed, found without running any of it."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Literal


def has_generated(kind: str, part: Literal["msg", "srv"]) -> bool:
    """Return whether PACKAGE/NAME has code that was generated for it.

    roslib imports any package that a type names, and a type comes from a page or from a node on the network.
    """
    package, _, name = kind.partition("/")
    if not package.isidentifier() or not name.isidentifier():
        return False
    try:
        found = find_spec(package)  # of a package without a dot nothing is imported
    except (ImportError, ValueError):
        return False
    folders = found.submodule_search_locations if found is not None else None
    return any(Path(folder, part, f"_{name}.py").is_file() for folder in folders or ())
