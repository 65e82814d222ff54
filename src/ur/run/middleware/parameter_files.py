"""Parameters of a plan as files for the nodes of ROS 2, where each node has its own parameters. Pure.

Each node gets `use_sim_time`, and the nodes that publish the robot's frames get its description; roslaunch sets both
for all nodes. The values of ROS 2 are numbers, texts, flags and lists of one kind: a list of maps becomes a map by
their `name`, other nested lists become texts, as in Nav2.
"""

import json
from collections.abc import Mapping, Sequence

from ur.launchfile.plan.specs import NodeSpec, ParamValue, Plan
from ur.launchfile.ros2_values import convert_map

_SIMULATED_TIME = "use_sim_time"
_DESCRIPTION = "robot_description"
_DESCRIBED = ("robot_state_publisher", "joint_state_publisher", "rviz2")


def file_name(folder: str, node: str) -> str:
    """Return the path of the file with a node's parameters."""
    return f"{folder}/{node.lstrip('/').replace('/', '-')}.parameters.yaml"


def format_parameters(plan: Plan, printed: Mapping[str, ParamValue]) -> dict[str, str]:
    """Return the content of each node's file, by its full name. `printed` are the values that programs have printed."""
    values = {each.name: printed.get(each.name, each.value) for each in plan.params}
    return {node.full_name: _format(_collect(node, values)) for node in plan.nodes}


def find_descriptions(nodes: Sequence[NodeSpec], values: Mapping[str, ParamValue]) -> dict[str, ParamValue]:
    """Return the robot's description as parameters of the nodes that publish its frames, by full names."""
    wanted = [node for node in nodes if node.type in _DESCRIBED]
    found = {f"{node.full_name}/{_DESCRIPTION}": _search(_DESCRIPTION, node.namespace, values) for node in wanted}
    return {name: value for name, value in found.items() if value is not None}


def _collect(node: NodeSpec, values: Mapping[str, ParamValue]) -> dict[str, object]:
    found: dict[str, object] = {}
    wanted = [_SIMULATED_TIME, *([_DESCRIPTION] if node.type in _DESCRIBED else [])]
    for name in wanted:
        if (value := _search(name, node.namespace, values)) is not None:
            found[name] = value
    prefix = f"{node.full_name}/"
    for name, value in values.items():
        if name.startswith(prefix):
            _put(found, name.removeprefix(prefix).split("/"), value)
    return found


def _search(name: str, namespace: str, values: Mapping[str, ParamValue]) -> ParamValue:
    """Find a parameter in a namespace or a parent of it, as ROS 1 searches it; None if it does not exist."""
    while True:
        if namespace + name in values:
            return values[namespace + name]
        if namespace == "/":
            return None
        namespace = namespace.rstrip("/").rpartition("/")[0] + "/"


def _put(found: dict[str, object], path: list[str], value: ParamValue) -> None:
    for step in path[:-1]:
        below = found.get(step)
        if not isinstance(below, dict):
            below = found[step] = {}
        found = below
    known = found.get(path[-1])
    if isinstance(known, dict) and isinstance(value, dict):
        for name, each in value.items():
            _put(known, [name], each)
    else:
        found[path[-1]] = value


def _format(found: Mapping[str, object]) -> str:
    plain = convert_map(found)
    return json.dumps({"/**": {"ros__parameters": plain}}, indent=1) + "\n" if plain else "{}\n"
