"""Nodes and their topics, services and actions: of a plan, without starting it, or of a running master."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ur.graph.boxes import Arrow, DrawnGraph, GraphBox, Kind
from ur.launchfile.plan.specs import NodeSpec, ParamValue, Plan
from ur.launchfile.query.topics import NameUse, Use, find_name_uses, remap_name
from ur.robot.base import Base, load_base
from ur.source.diagnostic import UserError

_PACKAGE = "ubiquity_launches"
_MAX_ROBOTS = 100
_Found = Iterator[tuple[str, Use, str]]

# What every ROS node has; it would hide everything else.
_COMMON_TOPICS = frozenset({"/rosout", "/rosout_agg", "/parameter_events"})
_TRANSFORMS = frozenset({"/tf", "/tf_static"})
_COMMON_NODES = frozenset({"/rosout"})


class _Builder:
    def __init__(self) -> None:
        self.boxes: dict[tuple[Kind, str], GraphBox] = {}
        self.arrows: dict[tuple[str, str], Arrow] = {}

    def box(self, kind: Kind, name: str, title: str = "") -> str:
        found = self.boxes.setdefault((kind, name), GraphBox(f"b{len(self.boxes)}", name, kind, title or name))
        return found.id

    def arrow(self, source: str, target: str, label: str = "", *, sure: bool = True) -> None:
        self.arrows.setdefault((source, target), Arrow(source, target, label, sure))

    def graph(self) -> DrawnGraph:
        return DrawnGraph(tuple(self.boxes.values()), tuple(self.arrows.values()))


def graph_plan(plan: Plan) -> DrawnGraph:
    """Return the graph of the topics, services and actions that the nodes of a plan use.

    Sources are `ready:` comments, the table of well-known nodes, the parameters and base of this project's nodes, and
    remaps; other nodes are boxes without arrows.
    """
    builder = _Builder()
    params = {param.name: param.value for param in plan.params}
    for node in plan.nodes:
        own = builder.box("node", node.full_name, f"{node.package}/{node.type}".lstrip("/"))
        for use in _find_uses(node, params):
            _connect(builder, own, use)
    return builder.graph()


def _find_uses(node: NodeSpec, params: Mapping[str, ParamValue]) -> Iterable[NameUse]:
    based = find_base_uses(node, params)
    yield from based
    names = {use.name for use in based}
    for use in find_name_uses(node):
        # The base and the parameters tell more than the table does.
        reported = use.evidence == "table" and use.use in ("publishes", "subscribes") and use.name not in _TRANSFORMS
        if not based or not (reported or (use.use is None and use.name in names)):
            yield use


def _connect(builder: _Builder, node: str, use: NameUse) -> None:
    label = f"{use.rate:g} Hz" if use.rate else use.doubt
    sure = not use.doubt
    match use.use:
        case "publishes":
            builder.arrow(node, builder.box("topic", use.name), label, sure=sure)
        case "subscribes":
            builder.arrow(builder.box("topic", use.name), node, label, sure=sure)
        case "offers-service" | "offers-action":
            builder.arrow(node, builder.box("service" if use.use == "offers-service" else "action", use.name))
        case "calls-service" | "uses-action":
            builder.arrow(builder.box("service" if use.use == "calls-service" else "action", use.name), node)
        case None:
            builder.arrow(node, builder.box("topic", use.name), label, sure=False)
        case _:  # frames are no names that two nodes share
            return


def graph_system(state: Sequence[Iterable[tuple[str, Sequence[str]]]], only: Iterable[str] = ()) -> DrawnGraph:
    """Return the graph of the nodes and topics of a master: `state` is the result of `getSystemState`.

    `only`: the nodes whose neighbourhood is shown; if empty, all. Services that every node has are left out.
    """
    builder = _Builder()
    publishers, subscribers = (dict(each) for each in state[:2])
    for topic, nodes in sorted(publishers.items()):
        if topic not in _COMMON_TOPICS:
            for node in sorted(set(nodes) - _COMMON_NODES):
                builder.arrow(builder.box("node", node), builder.box("topic", topic))
    for topic, nodes in sorted(subscribers.items()):
        if topic not in _COMMON_TOPICS:
            for node in sorted(set(nodes) - _COMMON_NODES):
                builder.arrow(builder.box("topic", topic), builder.box("node", node))
    wanted = frozenset(only)
    return _around(builder.graph(), wanted) if wanted else builder.graph()


def _around(graph: DrawnGraph, nodes: frozenset[str]) -> DrawnGraph:
    # The nodes, their topics, and other nodes on these topics.
    own = {box.id for box in graph.boxes if box.label in nodes}
    topics = {end for each in graph.arrows for end in (each.source, each.target) if {each.source, each.target} & own}
    kept = own | topics | {end for each in graph.arrows for end in _ends(each) if set(_ends(each)) & (topics - own)}
    arrows = tuple(each for each in graph.arrows if set(_ends(each)) & (topics - own))
    return DrawnGraph(tuple(box for box in graph.boxes if box.id in kept), arrows)


def _ends(arrow: Arrow) -> tuple[str, str]:
    return arrow.source, arrow.target


def neighbours(graph: DrawnGraph) -> Mapping[str, tuple[list[Arrow], list[Arrow]]]:
    """Return by id of a box its outgoing and its incoming arrows."""
    found: dict[str, tuple[list[Arrow], list[Arrow]]] = {box.id: ([], []) for box in graph.boxes}
    for arrow in graph.arrows:
        found[arrow.source][0].append(arrow)
        found[arrow.target][1].append(arrow)
    return found


def find_base_uses(node: NodeSpec, params: Mapping[str, ParamValue]) -> tuple[NameUse, ...]:
    """Return the topics that a simulator or driver adapter of this project uses because of its parameters and base.

    If the base is unknown, a lidar's topic is uncertain. Empty for other nodes.
    """
    find = _NODES.get(node.type) if node.package == _PACKAGE else None
    if find is None:
        return ()
    own = {
        name.removeprefix(f"{node.full_name}/"): value
        for name, value in params.items()
        if name.startswith(f"{node.full_name}/")
    }
    return tuple(
        NameUse(name if name.startswith("/") else remap_name(name, node), use, "base", doubt=doubt)
        for name, use, doubt in find(own)
    )


def _simulated(own: Mapping[str, ParamValue]) -> _Found:
    if own.get("devices"):
        yield "base_pose_ground_truth", "publishes", ""
        yield "~collisions", "publishes", ""
        return
    robots = own.get("robots")
    count = min(robots, _MAX_ROBOTS) if isinstance(robots, int) else 1
    if own.get("publish_clock") is True:
        yield "/clock", "publishes", ""
    for prefix in [f"robot_{number}/" for number in range(count)] if count > 1 else [""]:
        for name in ("odom", "joint_states", "base_pose_ground_truth"):
            yield prefix + name, "publishes", ""
        yield f"~{prefix}collisions", "publishes", ""
        yield f"{prefix}cmd_vel", "subscribes", ""
        for name, doubt in _sensor_topics(own):
            yield prefix + name, "publishes", doubt


def _sensor_topics(own: Mapping[str, ParamValue]) -> Iterator[tuple[str, str]]:
    base = _load(own)
    if base is None:
        yield "scan", "only if the base has a lidar"
        return
    for _, sensor in base.list_sensors():
        yield from ((topic, "") for topic in sensor.topics())


def _adapted(own: Mapping[str, ParamValue]) -> _Found:
    base = _load(own)
    yield "joint_states", "publishes", ""
    yield "odom", "subscribes", ""
    if own.get("publish_tf") is True:
        yield "/tf", "publishes", ""
    if own.get("rename_scan") is True and (base is None or base.lidar is not None):
        doubt = "only if the base has a lidar" if base is None else ""
        yield base.lidar.topic if base and base.lidar else "scan", "publishes", doubt
        yield "driver/scan", "subscribes", doubt
    if own.get("bumper_messages"):
        yield "driver/bumpers", "subscribes", ""
        if base is not None and base.bumpers is not None:
            yield from ((topic, "publishes", "") for topic in base.bumpers.topics())


def _base_driven(own: Mapping[str, ParamValue]) -> _Found:
    base = _load(own)
    for name in ("odom", "joint_states", "/tf"):
        yield name, "publishes", ""
    yield "cmd_vel", "subscribes", ""
    own_drivers = {each.part for each in base.drivers} if base else frozenset[str]()
    for name, sensor in base.list_sensors() if base else ():
        if name in _OF_BOARDS and name not in own_drivers:
            yield from ((topic, "publishes", "") for topic in sensor.topics())


def _lidar_driven(own: Mapping[str, ParamValue]) -> _Found:
    base = _load(own)
    yield base.lidar.topic if base and base.lidar else "scan", "publishes", ""


def _sonar_driven(own: Mapping[str, ParamValue]) -> _Found:
    base = _load(own)
    yield base.sonars.topic if base and base.sonars else "sonars", "publishes", ""


def _imu_driven(own: Mapping[str, ParamValue]) -> _Found:
    base = _load(own)
    yield base.imu.topic if base and base.imu else "imu/data", "publishes", ""


def _load(own: Mapping[str, ParamValue]) -> Base | None:
    try:
        return load_base(str(own.get("package", "")), str(own.get("base", "")), str(own.get("variant", "")))
    except (UserError, OSError):
        return None


_OF_BOARDS = ("lidar", "sonars", "bumpers", "cliffs", "battery")
_NODES = {
    "simulator": _simulated,
    "driver_adapter": _adapted,
    "base_driver": _base_driven,
    "lidar_driver": _lidar_driven,
    "sonar_driver": _sonar_driven,
    "imu_driver": _imu_driven,
}
