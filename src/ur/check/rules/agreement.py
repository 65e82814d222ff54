"""Rules about nodes that are given parameters one by one, and have to agree: clock, frames, types of commands, QoS."""

import re
from collections.abc import Iterable, Iterator, Mapping
from itertools import combinations

from ur.check.rule import Example, PlanView, Rule, RuleFinding, RuleGroup, launch_example
from ur.check.worlds import has_marker
from ur.launchfile.plan.specs import NodeSpec
from ur.source.diagnostic import Note, Severity

# Nodes whose results depend on the time of transforms: one of them on another clock finds none.
_TIMED = frozenset(
    {
        ("nav2_amcl", "amcl"),
        ("nav2_behaviors", "behavior_server"),
        ("nav2_bt_navigator", "bt_navigator"),
        ("nav2_controller", "controller_server"),
        ("nav2_planner", "planner_server"),
        ("robot_localization", "ekf_node"),
        ("robot_localization", "ukf_node"),
        ("robot_state_publisher", "robot_state_publisher"),
        ("slam_toolbox", "async_slam_toolbox_node"),
        ("slam_toolbox", "sync_slam_toolbox_node"),
    }
)
_TREES = ("robot_state_publisher", "nav2_amcl", "slam_toolbox", "robot_localization")  # publish transforms
_FRAMES = (
    "frame_prefix",
    "odom_frame",
    "odom_frame_id",
    "base_frame",
    "base_link_frame",
    "base_frame_id",
    "robot_description",
)
_TYPES = {True: "TwistStamped", False: "Twist"}
# Parameter for TwistStamped, and the topics of commands
_STAMPED: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "nav2_behaviors": ("enable_stamped_cmd_vel", ("cmd_vel",)),
    "nav2_controller": ("enable_stamped_cmd_vel", ("cmd_vel",)),
    "nav2_velocity_smoother": ("enable_stamped_cmd_vel", ("cmd_vel", "cmd_vel_smoothed")),
    "teleop_twist_joy": ("publish_stamped_twist", ("cmd_vel",)),
    "teleop_twist_keyboard": ("stamped", ("cmd_vel",)),
    "twist_mux": ("use_stamped", ("cmd_vel_out",)),
}
_OVERRIDE = re.compile(r"qos_overrides\.(/[\w/]+)\.(publisher|subscription)(?:_\w+)?\.(reliability|durability)")
# What a publisher has, and what its subscription must not ask for
_CANNOT_MATCH = {("reliability", "best_effort", "reliable"), ("durability", "volatile", "transient_local")}


def _parameters(view: PlanView) -> Mapping[str, Mapping[str, object]]:
    names = sorted({node.full_name for node in _nodes(view)}, key=len)
    found: dict[str, dict[str, object]] = {name: {} for name in names}
    for param in view.plan.params:
        owner, _, name = param.name.rpartition("/")
        while owner and owner not in found:
            owner, _, part = owner.rpartition("/")
            name = f"{part}/{name}"
        if owner:
            found[owner][name] = param.value
    return found


def _nodes(view: PlanView) -> Iterator[NodeSpec]:
    counts: dict[str, int] = {}
    for node in view.plan.nodes:
        counts[node.full_name] = counts.get(node.full_name, 0) + 1
    for node in view.plan.nodes:
        is_certain = counts[node.full_name] == 1 and not has_marker(node.full_name) and "<" not in node.full_name
        if view.plan.launcher != "roslaunch" and node.kind != "program" and is_certain:
            yield node


def _find_clocks(view: PlanView) -> Iterable[RuleFinding]:
    given = _parameters(view)
    timed = [node for node in _nodes(view) if (node.package, node.type) in _TIMED]
    clocks = [(node, given[node.full_name].get("use_sim_time", False)) for node in timed]
    simulated = next((node for node, clock in clocks if clock is True), None)
    for node, clock in clocks:
        if simulated is not None and clock is False and not view.plan.gaps:
            yield RuleFinding(
                node.origin.span,
                f"{node.full_name} has the computer's time, and {simulated.full_name} simulated time",
                "set use_sim_time for all nodes: SetParameter('use_sim_time', ...)",
                (Note(f"{simulated.full_name} is here", simulated.origin.span),),
                subject=node.full_name,
            )


def _find_mixed_trees(view: PlanView) -> Iterable[RuleFinding]:
    given = _parameters(view)
    first: dict[str, NodeSpec] = {}
    for node in _nodes(view):
        if node.package not in _TREES or any(old.lstrip("/") == "tf" for old, _ in node.remaps):
            continue
        values = given[node.full_name]
        if "<robot" not in str(values.get("robot_description", "<robot")):
            continue  # what xacro prints decides
        frames = [str(values.get(name, "")) for name in (*_FRAMES, "robot_description")]
        other = first.setdefault(f"{node.package} {node.type} {frames}", node)
        if other.namespace != node.namespace and not any("/" in each for each in frames[:-1]):
            yield RuleFinding(
                node.origin.span,
                f"{node.full_name} publishes on /tf, as {other.full_name} does: the frames of two robots mix",
                "remap them: remappings=[('/tf', 'tf'), ('/tf_static', 'tf_static')]",
                (Note(f"{other.full_name} is here", other.origin.span),),
                subject=node.full_name,
            )


def _find_mixed_commands(view: PlanView) -> Iterable[RuleFinding]:
    given = _parameters(view)
    ends: list[tuple[NodeSpec, bool, set[str]]] = []
    for node in _nodes(view):
        name, topics = _STAMPED.get(node.package, ("", ()))
        stamped = given[node.full_name].get(name)
        if isinstance(stamped, bool):
            ends.append((node, stamped, {_topic(node, topic) for topic in topics}))
    for (one, stamped, ours), (other, others, theirs) in combinations(ends, 2):
        for topic in sorted(ours & theirs) if stamped is not others else ():
            yield RuleFinding(
                other.origin.span,
                f"{other.full_name} has {_TYPES[others]} on {topic}, and {one.full_name} has {_TYPES[stamped]}",
                f"set {_STAMPED[other.package][0]} as in {one.full_name}: a topic has one type",
                (Note(f"{one.full_name} is here", one.origin.span),),
                subject=topic,
            )


def _topic(node: NodeSpec, name: str) -> str:
    for old, new in node.remaps:
        if old in (name, f"/{name}", node.namespace + name):
            name = new
            break
    return name if name.startswith("/") else node.namespace + name


def _find_qualities(view: PlanView) -> Iterable[RuleFinding]:
    places = {node.full_name: node for node in _nodes(view)}
    found: dict[tuple[str, str, str], list[tuple[NodeSpec, str]]] = {}
    for full_name, values in _parameters(view).items():
        for name, value in values.items():
            override = _OVERRIDE.fullmatch(name)
            if override is not None:
                topic, end, quality = override.groups()
                found.setdefault((topic, end, quality), []).append((places[full_name], str(value)))
    for (topic, end, quality), subscriptions in found.items():
        for publisher, has in found.get((topic, "publisher", quality), ()) if end == "subscription" else ():
            for node, wants in subscriptions:
                if (quality, has, wants) in _CANNOT_MATCH:
                    yield RuleFinding(
                        node.origin.span,
                        f"{node.full_name} gets nothing on {topic}: it wants {wants}, {publisher.full_name} is {has}",
                        f"set {quality} of both to {has}",
                        (Note(f"{publisher.full_name} is here", publisher.origin.span),),
                        subject=topic,
                    )


def _file(*nodes: str) -> Example:
    names = ("first", "second")[: len(nodes)]
    body = "".join(f"    {name} = {node}\n" for name, node in zip(names, nodes, strict=True))
    return launch_example(
        "from launch import LaunchDescription\nfrom launch_ros.actions import Node\n\n\n"
        f"def generate_launch_description():\n{body}    return LaunchDescription([{', '.join(names)}])",
        name="launch/example.launch.py",
    )


def _node(package: str, executable: str, *more: str, bad: bool = False) -> str:
    words = (f'package="{package}"', f'executable="{executable}"', f'name="{executable}"', *more)
    lines = "".join(f"        {word},\n" for word in words)
    return f"{'«Node»' if bad else 'Node'}(\n{lines}    )"


_SIMULATED = _node("robot_state_publisher", "robot_state_publisher", 'parameters=[{"use_sim_time": True}]')
_LEFT = _node("robot_state_publisher", "robot_state_publisher", 'namespace="left"')
_RIGHT = 'namespace="right"'
_STAMPED_CONTROLLER = _node("nav2_controller", "controller_server", 'parameters=[{"enable_stamped_cmd_vel": True}]')
_CAMERA = _node("demo_nodes", "talker", 'parameters=[{"qos_overrides./news.publisher.reliability": "best_effort"}]')


def _listener(wanted: str, *, bad: bool = False) -> str:
    values = f'{{"qos_overrides./news.subscription.reliability": "{wanted}"}}'
    return _node("demo_nodes", "listener", f"parameters=[{values}]", bad=bad)


RULES = (
    Rule(
        id="mixed-clocks",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="Some nodes have simulated time, and others that need the same transforms have not.",
        explanation="""
Transforms are looked up by their time. A node on the clock of the computer finds none of those of the simulation.
Examined are nodes of Nav2, robot_localization, robot_state_publisher and slam_toolbox.
""",
        bad=(_file(_SIMULATED, _node("nav2_amcl", "amcl", 'parameters=[{"use_sim_time": False}]', bad=True)),),
        good=(_file(_SIMULATED, _node("nav2_amcl", "amcl", 'parameters=[{"use_sim_time": True}]')),),
        plan=_find_clocks,
    ),
    Rule(
        id="mixed-commands",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="A topic of velocity commands has Twist from one node and TwistStamped from another.",
        explanation="""
A topic has one type: nodes with another one neither send nor receive. Compared are nodes of Nav2, twist_mux and
teleop_twist whose parameter for it is set, on the topics to which they are remapped.
""",
        bad=(
            _file(
                _STAMPED_CONTROLLER,
                _node("teleop_twist_joy", "teleop_node", 'parameters=[{"publish_stamped_twist": False}]', bad=True),
            ),
        ),
        good=(
            _file(
                _STAMPED_CONTROLLER,
                _node("teleop_twist_joy", "teleop_node", 'parameters=[{"publish_stamped_twist": True}]'),
            ),
        ),
        plan=_find_mixed_commands,
    ),
    Rule(
        id="mixed-qualities",
        group=RuleGroup.VALUES,
        severity=Severity.WARNING,
        summary="Overrides of QoS let a publisher and a subscription never match.",
        explanation="""
A subscription that asks for `reliable` gets nothing from a publisher that is `best_effort`, and one that asks for
`transient_local` nothing from one that is `volatile`.
""",
        bad=(_file(_CAMERA, _listener("reliable", bad=True)),),
        good=(_file(_CAMERA, _listener("best_effort")),),
        plan=_find_qualities,
    ),
    Rule(
        id="mixed-transforms",
        group=RuleGroup.NAMES,
        severity=Severity.WARNING,
        summary="Nodes of two namespaces publish the same frames on one /tf.",
        explanation="""
A namespace does not reach `/tf`: its name begins with a slash. Two robots need remappings, or frames with a prefix.
""",
        bad=(_file(_LEFT, _node("robot_state_publisher", "robot_state_publisher", _RIGHT, bad=True)),),
        good=(
            _file(_LEFT, _node("robot_state_publisher", "robot_state_publisher", _RIGHT, 'remappings=[("/tf", "tf")]')),
        ),
        plan=_find_mixed_trees,
    ),
)
