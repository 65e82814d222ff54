"""The nodes of a process and their parameters, in the file that `ur` writes for it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from ur.source.foreign.json_values import read_json

_MOST = 1 << 26  # bytes


@dataclass(frozen=True, slots=True)
class NodeStart:
    """A node: its full name, the module and its arguments, and full names that replace others."""

    name: str
    words: tuple[str, ...]
    remaps: dict[str, str] = field(default_factory=dict)
    required: bool = False
    respawn: bool = False
    respawn_delay: float = 0.0
    terminal: bool = False


@dataclass(frozen=True, slots=True)
class ProcessPlan:
    """The nodes of a process. `log` takes the nodes' lines where one of them has the terminal.

    `parameters` is the file of all of them, `viewers` the socket at which viewers of this computer ask for nodes.
    """

    name: str
    nodes: tuple[NodeStart, ...]
    log: str
    parameters: str
    viewers: str


def read_plan(path: str) -> ProcessPlan:
    """Read the file. Raises OSError, and ValueError for an invalid file."""
    return read_json(Path(path).read_bytes(), ProcessPlan, _MOST)


def read_parameters(path: str) -> dict[str, object]:
    """Read parameters by their full names. Raises OSError, and ValueError for an invalid file."""
    return read_json(Path(path).read_bytes(), dict[str, object], _MOST)
