"""Claims of a run: the nodes that it starts, their definitions, and the runs whose nodes it uses.

They are stored in the run's control folder when it is registered, before any of the nodes is started.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, ParamSpec
from ur.source.foreign.json_values import read_json, write_json
from ur.source.replace import replace_file

BASE_FILE = "/m_robot_base/launch/m_robot_base.launch.xml"
_FILE = "claims.json"
_MAX_BYTES = 4 << 20
_MAX_VALUE = 200  # characters, beyond which a value is stored as a hash

Definition = Mapping[str, str]
"""A node's program, arguments, remaps and private parameters, by names such as `param world_file`."""


@dataclass(frozen=True, slots=True)
class Claims:
    """Nodes of a run by full name; `base` are the robot base's, `joined` the ids of the runs that it has joined."""

    nodes: Mapping[str, Definition] = field(default_factory=dict)
    base: tuple[str, ...] = ()
    joined: tuple[str, ...] = ()


def make_claims(nodes: Iterable[NodeSpec], params: Iterable[ParamSpec], joined: Iterable[str]) -> Claims:
    """Return the claims of a run that starts these nodes."""
    chosen = tuple(nodes)
    return Claims(
        define_nodes(chosen, params),
        tuple(node.full_name for node in chosen if is_base(node)),
        tuple(joined),
    )


def define_nodes(nodes: Iterable[NodeSpec], params: Iterable[ParamSpec]) -> dict[str, Definition]:
    """Return the definition of each node, by full name."""
    found: dict[str, dict[str, str]] = {node.full_name: _define(node) for node in nodes}
    for param in params:
        for name, items in found.items():
            if param.name.startswith(name + "/"):
                items[f"param {param.name[len(name) + 1 :]}"] = _shorten(str(param.command or param.value))
    return dict(found)


def is_base(item: NodeSpec | ParamSpec) -> bool:
    """Return whether a node or parameter belongs to the robot base: it is defined in `m_robot_base` or below."""
    return any(span.file.path.endswith(BASE_FILE) for span in (item.origin.span, *item.origin.includes))


def write_claims(folder: str, claims: Claims) -> None:
    """Write the claims of a run to its control folder. Raises OSError: the folder was removed, or the disk is full."""
    replace_file(Path(folder, _FILE), write_json(claims), lasting=False)


def read_claims(folder: str) -> Claims:
    """Return the claims in a control folder; empty if they cannot be read."""
    try:
        with Path(folder, _FILE).open("rb") as file:
            return read_json(file.read(_MAX_BYTES), Claims, _MAX_BYTES)
    except (OSError, ValueError):
        return Claims()


def _define(node: NodeSpec) -> dict[str, str]:
    items = {"program": f"{node.package}/{node.type}", "args": " ".join(node.args.split())}
    items |= {f"remap {source}": target for source, target in node.remaps}
    return items | {f"env {name}": value for name, value in node.env}


def _shorten(value: str) -> str:
    if len(value) <= _MAX_VALUE:
        return value
    from hashlib import sha256  # slow to import, and rarely needed

    return "sha256:" + sha256(value.encode("utf-8", "surrogatepass")).hexdigest()
