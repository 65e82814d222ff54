"""Decision about the nodes of a plan that are already running at the same master. Pure."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from pathlib import Path

from ur.launchfile.plan.specs import NodeSpec, ParamSpec, Plan
from ur.run.record.registry import encode
from ur.run.startup.node_selection import keep_nodes
from ur.source.data_classes import dataclass, field
from ur.source.replace import replace_file

BASE_FILE = "/m_robot_base/launch/m_robot_base.launch.xml"
_FILE = "claims.json"
_MAX_BYTES = 4 << 20
_MAX_VALUE = 200  # characters, beyond which a value is stored as a hash
_LOCALISERS: dict[str, tuple[str, str]] = {  # the parameters of the frames between which they publish the transform
    "amcl": ("global_frame_id", "odom_frame_id"),
    "async_slam_toolbox_node": ("map_frame", "odom_frame"),
    "fake_localization": ("global_frame_id", "odom_frame_id"),
    "fiducial_slam": ("map_frame", "odom_frame"),
    "gmapping": ("map_frame", "odom_frame"),
    "hector_mapping": ("map_frame", "odom_frame"),
    "lifelong_slam_toolbox_node": ("map_frame", "odom_frame"),
    "localization_slam_toolbox_node": ("map_frame", "odom_frame"),
    "rtabmap": ("map_frame_id", "odom_frame_id"),
    "slam_gmapping": ("map_frame", "odom_frame"),
    "sync_slam_toolbox_node": ("map_frame", "odom_frame"),
}

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
        define_nodes(chosen, params), tuple(node.full_name for node in chosen if is_base(node)), tuple(joined)
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
    replace_file(Path(folder, _FILE), encode(claims), lasting=False)


def read_claims(folder: str) -> Claims:
    """Return the claims in a control folder; empty if they cannot be read."""
    from ur.source.foreign.json_values import read_json  # where other runs are

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


@dataclass(frozen=True, slots=True)
class Held:
    """A node that is already running.

    `run` is the id of its run, '' for one that is not a run of this user on this computer. `definition` is None if
    unknown.
    """

    name: str
    run: str = ""
    definition: Definition | None = None


@dataclass(frozen=True, slots=True)
class Decision:
    """The decision about a plan's nodes that are already running.

    `base` and `used` are not started: the robot base's, and others with the same definition in this plan. `renamed` own
    a terminal and start under other names. `refused` would end running nodes.
    """

    base: tuple[Held, ...] = ()
    used: tuple[Held, ...] = ()
    renamed: tuple[Held, ...] = ()
    refused: tuple[Held, ...] = ()

    @property
    def joined(self) -> tuple[Held, ...]:
        """Return the nodes that are not started because they are already running."""
        return self.base + self.used


@dataclass(frozen=True, slots=True)
class Misfit:
    """A command-line argument that the running robot contradicts: its `node` has `item` set to `value`."""

    argument: str
    node: str
    run: str
    item: str
    value: str


def decide(plan: Plan, held: Iterable[Held]) -> Decision:
    """Decide about each node of a plan that is already running."""
    running = {each.name: each for each in held}
    nodes = [node for node in plan.nodes if node.full_name in running]
    defined = define_nodes(nodes, plan.params)
    base, used, renamed, refused = [], [], [], []
    for node in nodes:
        each = running[node.full_name]
        if node.terminal:
            renamed.append(each)
        elif is_base(node):
            base.append(each)
        elif each.definition == defined[node.full_name]:
            used.append(each)
        else:
            refused.append(each)
    return Decision(tuple(base), tuple(used), tuple(renamed), tuple(refused))


def find_misfits(plan: Plan, decision: Decision, varied: Mapping[str, Sequence[Plan]]) -> list[Misfit]:
    """Return the arguments that request a robot other than the joined one.

    `varied` holds, by argument as it was written, plans in which that argument has other values: the differences
    between them depend on it.
    """
    wanted = define_nodes(plan.nodes, plan.params)
    found = []
    for argument, plans in varied.items():
        others = [define_nodes(other.nodes, other.params) for other in plans]
        for each in decision.base:
            ours, theirs = wanted.get(each.name, {}), each.definition
            if theirs is None:
                continue
            wrong = [key for key in ours if ours[key] != theirs.get(key)]
            found += [
                Misfit(argument, each.name, each.run, key, theirs.get(key, ""))
                for key in wrong
                if any(each.name in other and other[each.name].get(key) != ours[key] for other in others)
            ]
    return found


def find_localisers(nodes: Mapping[str, Definition]) -> dict[str, tuple[str, str]]:
    """Return the frames, parent and child, between which each localiser of these nodes publishes the transform."""
    found = {}
    for name, items in nodes.items():
        parameters = _LOCALISERS.get(items.get("program", "").rpartition("/")[2])
        if parameters is not None:
            parent, child = (
                items.get(f"param {key}", default).strip("/")
                for key, default in zip(parameters, ("map", "odom"), strict=True)
            )
            found[name] = (parent, child or items.get("param base_frame", "base_link").strip("/"))
    return found


def leave_out(plan: Plan, decision: Decision) -> Plan:
    """Return the plan without the running nodes, and without the global settings in the robot base's files."""
    joined = {each.name for each in decision.joined}
    if not joined:
        return plan
    plan = keep_nodes(plan, {node.full_name for node in plan.nodes} - joined)
    private = tuple(node.full_name + "/" for node in plan.nodes)
    return plan._replace(
        params=tuple(
            each for each in plan.params if not (decision.base and is_base(each)) or each.name.startswith(private)
        ),
        commands=tuple(each for each in plan.commands if not _touches(each.name, joined)),
    )


def find_free_names(names: Collection[str], taken: Collection[str]) -> dict[str, str]:
    """Return a new name for each of these nodes: with `_2` appended, or the first free number."""
    used = set(taken)
    chosen = {}
    for name in names:
        number = 2
        while f"{name}_{number}" in used:
            number += 1
        chosen[name] = f"{name}_{number}"
        used.add(chosen[name])
    return chosen


def _touches(space: str, nodes: Collection[str]) -> bool:
    below = space.rstrip("/") + "/"
    return any(name.startswith(below) or below.startswith(name + "/") for name in nodes)
