"""Topics, services and actions of a node, from its launch file and the table of well-known nodes."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from ur.launchfile.plan.names import canonical_name, join_names
from ur.launchfile.plan.specs import NodeSpec
from ur.launchfile.query.known_nodes import find_interface

Use = Literal[
    "publishes", "subscribes", "offers-service", "calls-service", "offers-action", "uses-action", "sends-frame"
]
Evidence = Literal["ready", "comment", "table", "base", "remap"]


@dataclass(frozen=True, slots=True)
class NameUse:
    """Use of a name by a node. `use` is None for a name that is known from a remap only.

    `name` is the full name after remapping. `rate` is in Hz, from a `ready:` comment. `doubt` is the reason why the use
    is uncertain; empty if it is certain.
    """

    name: str
    use: Use | None
    evidence: Evidence
    rate: float | None = None
    doubt: str = ""


_STAMPED = "_stamped"
_READY: dict[str, Use] = {
    "topic": "publishes",
    "service": "offers-service",
    "frame": "sends-frame",
    "action": "offers-action",
}


def find_name_uses(node: NodeSpec) -> tuple[NameUse, ...]:
    """List the names that a node uses: its comments, then the table of well-known nodes, then its remaps."""
    found: dict[tuple[str, Use | None], NameUse] = {}
    for each in (*_from_ready(node), *_from_comments(node), *_from_table(node)):
        found.setdefault((each.name, each.use), each)
    named = {name for name, _ in found}
    for source, target in node.remaps:
        name = resolve_name(target, node)
        if name not in named and resolve_name(source, node) != name:
            doubt = f"{source} is remapped; the node may publish or subscribe it"
            found.setdefault((name, None), NameUse(name, None, "remap", doubt=doubt))
    return tuple(found.values())


def resolve_name(name: str, node: NodeSpec) -> str:
    """Return the full name of a name in a node's code: `~x` is below the node, others are in its namespace."""
    if name.startswith("~"):
        return canonical_name(f"{node.full_name}/{name[1:]}")
    return canonical_name(join_names(node.namespace, name))


def remap_name(name: str, node: NodeSpec) -> str:
    """Return the full name with the node's remaps applied; the last matching one is used, as in roslaunch."""
    full = resolve_name(name, node)
    targets = {resolve_name(source, node): target for source, target in node.remaps}
    if full in targets:
        return resolve_name(targets[full], node)
    plain = full.removesuffix(_STAMPED)
    if node.package == "ubiquity_launches" and plain != full and plain in targets:
        return resolve_name(targets[plain], node) + _STAMPED  # our nodes append it to the remapped name
    return full


def _from_ready(node: NodeSpec) -> Iterator[NameUse]:
    for condition in node.ready:
        if condition.kind != "process":
            yield NameUse(condition.name, _READY[condition.kind], "ready", condition.rate)


def _from_comments(node: NodeSpec) -> Iterator[NameUse]:
    for use, topic in node.topics:
        yield NameUse(remap_name(topic, node), "publishes" if use == "publishes" else "subscribes", "comment")


def _from_table(node: NodeSpec) -> Iterator[NameUse]:
    interface = find_interface(node.type, node.package)
    if interface is None:
        return
    uses: tuple[tuple[Use, tuple[str, ...]], ...] = (
        ("publishes", interface.publishes),
        ("subscribes", interface.subscribes),
        ("offers-service", interface.services),
        ("calls-service", interface.calls),
        ("offers-action", interface.actions),
        ("uses-action", interface.uses_actions),
    )
    for use, names in uses:
        for name in names:
            # tf is one topic for all, wherever a node is.
            full = f"/{name}" if name in ("tf", "tf_static", "clock") else remap_name(name, node)
            yield NameUse(full, use, "table")
