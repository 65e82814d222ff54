"""Facts of a domain of ROS 2, in a file: settings for all nodes of its runs. `ur_nodes` reads and changes it."""

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

from ur.source.replace import replace_file

_MOST = 1 << 20  # characters


def read_facts(path: str) -> dict[str, object]:
    """Return the facts in a file; empty if it cannot be read."""
    from ur.source.foreign.json_values import read_json  # not for those who only name the file

    with suppress(OSError, ValueError), Path(path).open(encoding="utf-8") as file:
        return read_json(file.read(_MOST), dict[str, object], _MOST)
    return {}


def write_facts(path: str, facts: Mapping[str, object]) -> None:
    """Write facts atomically. Raises OSError."""
    Path(path).parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    replace_file(path, json.dumps(dict(facts)), lasting=False)


def add_parameters(path: str, values: Mapping[str, object]) -> None:
    """Add parameters by their full names, also of nodes that are left out: as on a parameter server, others read them.

    What JSON cannot hold is left out. Raises OSError.
    """
    found = read_facts(path)
    for name, value in values.items():
        with suppress(TypeError, ValueError):
            json.dumps(value, allow_nan=False)
            found[name] = value
    write_facts(path, found)


def clear_facts(path: str) -> None:
    """Remove facts, and the parameters beside them that nodes have stored for their next start."""
    file = Path(path)
    with suppress(OSError):
        for each in (file, *file.parent.glob(f"{file.stem}.*.json")):
            each.unlink(missing_ok=True)
