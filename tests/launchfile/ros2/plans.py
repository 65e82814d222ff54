"""Plans of launch files of ROS 2 that tests write, in a world of their own."""

from collections.abc import Mapping, Sequence

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.ros2.load import load_ros2
from ur.launchfile.world.memory import MemoryWorld
from ur.source.diagnostic import Severity

IMPORTS = "\n".join(
    f"from {module} import *"
    for module in (
        "launch", "launch.actions", "launch.conditions", "launch.event_handlers", "launch.substitutions",
        "launch.launch_description_sources", "launch_ros.actions", "launch_ros.descriptions",
        "launch_ros.substitutions",
    )
)  # fmt: skip
PACKAGES = {"demo": "/opt/demo/share/demo", "nav": "/opt/nav/share/nav", "launch": "/opt/launch/share/launch"}
ENVIRONMENT = {"HOME": "/home/robot", "PATH": "/usr/bin", "ROBOT": "r2"}
FILES = {
    "/opt/demo/share/demo/package.xml": "<package/>",
    "/opt/demo/share/demo/config/p.yaml": "/**:\n  ros__parameters:\n    rate: 5\n    deep: {inner: true}\n",
    "/opt/demo/share/demo/text.txt": "content",
}


def python(*actions: str, before: str = "") -> str:
    """Return a Python launch file with these actions."""
    body = "".join(f"        {action},\n" for action in actions)
    return f"{IMPORTS}\n{before}\ndef generate_launch_description():\n    return LaunchDescription([\n{body}    ])\n"


def load(
    text: str,
    name: str = "/ws/a.launch.py",
    files: Mapping[str, str | bytes] | None = None,
    arguments: Sequence[str] = (),
    environment: Mapping[str, str] | None = None,
) -> Plan:
    """Return the plan of a launch file."""
    given = {**FILES, name: text, **(files or {})}
    return load_ros2(name, arguments, MemoryWorld(given, PACKAGES, environment or ENVIRONMENT))


def load_clean(
    text: str,
    name: str = "/ws/a.launch.py",
    files: Mapping[str, str | bytes] | None = None,
    arguments: Sequence[str] = (),
) -> Plan:
    """Return the plan of a launch file that is all right and all known."""
    plan = load(text, name, files, arguments)
    assert not plan.diagnostics, [found.message for found in plan.diagnostics]
    assert not plan.gaps, [gap.reason for gap in plan.gaps]
    return plan


def describe(node: NodeSpec) -> str:
    """Return what starts, in one line."""
    parts = [node.kind, node.full_name, f"{node.package}/{node.type}", *node.words]
    parts += [f"{source}:={target}" for source, target in node.remaps]
    parts += [f"{name}={value}" for name, value in node.env]
    parts += [f"without {name}" for name in node.unset]
    if node.container:
        parts.append(f"in {node.container}")
    if node.trigger is not None:
        parts.append(f"when {node.trigger.kind} {node.trigger.node or node.trigger.seconds}")
    return " ".join(parts)


def describe_all(plan: Plan) -> list[str]:
    """Return what starts, in order."""
    return [describe(node) for node in plan.nodes]


def parameters(plan: Plan, node: str = "/n") -> dict[str, object]:
    """Return the parameters of a node by their names."""
    return {each.name[len(node) + 1 :]: each.value for each in plan.params if each.name.startswith(f"{node}/")}


def rules(plan: Plan, *, errors: bool = False) -> list[str]:
    """Return the rules of the findings."""
    return [found.rule for found in plan.diagnostics if not errors or found.severity is Severity.ERROR]


def xml(body: str) -> str:
    """Return a launch file in XML."""
    return f"<launch>{body}</launch>"
