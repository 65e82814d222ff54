"""Components and lifecycle nodes of a plan: programs that ask for them through the services of the running nodes.

Each is a process of `ur_nodes.launch_steps_node` with a file of its calls. Sources: launch_ros'
`get_composable_node_load_request`, `to_parameters_list` and `LifecycleNode`.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import cast

from ur.launchfile.plan.specs import ActionSpec, NodeSpec, ParameterFile, ParamValue, Plan, ReadyCondition, Trigger
from ur.launchfile.ros2.parameters import ParameterSections, flatten
from ur.launchfile.world import World
from ur.run.process.command import PRIVATE, UnitProgram
from ur.run.supervisor.state import Unit
from ur.system.ros import node_command

_MODULE = "ur_nodes.launch_steps_node"
_KINDS: Mapping[type, tuple[int, str]] = {
    bool: (1, "bool"),
    int: (2, "integer"),
    float: (3, "double"),
    str: (4, "string"),
    bytes: (5, "byte"),
}
_TO_ARRAY = 4  # from the number of a type to that of its array; bytes have only one
Fields = dict[str, object]
Planned = tuple[UnitProgram, Trigger | None, float]
"""A program, the event that starts it, and its place among the nodes of the plan."""


def describe_steps(plan: Plan, world: World) -> tuple[tuple[Planned, ...], dict[int, Trigger]]:
    """Return the programs of components and lifecycle nodes, and triggers in place of those of states, by their ids.

    A change of state is awaited by a program that then ends.
    """
    found: list[Planned] = []
    awaited: dict[int, Trigger] = {}
    names: dict[str, int] = {}

    def add(name: str, calls: Sequence[Fields], trigger: Trigger | None, position: float) -> str:
        number = names[name] = names.get(name, 0) + 1
        unit = name if number == 1 else f"{name}-{number}"
        found.append((_program(unit, calls, world), trigger, position))
        return unit

    for container, trigger, position, nodes in _group(plan.nodes):
        calls = [_load(node, container, dict(plan.written), world) for node in nodes]
        add(f"{container}/load", calls, trigger, position)
    for action in plan.actions:
        if action.kind == "state":
            add(f"{action.node}/change_state", _steps(action), action.trigger, action.position + 0.5)
    triggers = [*(node.trigger for node in plan.nodes), *(action.trigger for action in plan.actions)]
    for trigger in triggers:
        each = trigger
        while each is not None:
            if each.kind == "state" and id(each) not in awaited:
                call: Fields = {"service": f"{each.node}/get_state", "fields": {}, "until": each.states[1]}
                unit = add(f"{each.node}/await_{each.states[1] or 'state'}", [call], each.after, 0)
                awaited[id(each)] = each._replace(node=unit)
            each = each.after
    return tuple(found), awaited


def _group(nodes: Sequence[NodeSpec]) -> Iterator[tuple[str, Trigger | None, int, list[NodeSpec]]]:
    """Yield the components that one action loads, in order."""
    groups: dict[tuple[str, int], tuple[str, Trigger | None, int, list[NodeSpec]]] = {}
    for position, node in enumerate(nodes, 1):
        if node.kind == "component":
            key = (node.container, id(node.trigger))
            groups.setdefault(key, (node.container, node.trigger, position, []))[3].append(node)
    yield from groups.values()


def _steps(action: ActionSpec) -> list[Fields]:
    service = f"{action.node}/change_state"
    return [
        {"service": service, "fields": {"transition": {"id": int(each)}}, "about": f"transition {each}"}
        for each in action.text.split()
        if each.isdigit()
    ]


def _program(unit: str, calls: Sequence[Fields], world: World) -> UnitProgram:
    name = f"steps/{unit.strip('/').replace('/', '-')}.json"
    return UnitProgram(
        unit=Unit(unit, planned=True, helper=True),
        argv=(*node_command(world.environment), _MODULE, PRIVATE + name),
        log_name=unit.strip("/").replace("/", "-"),
        screen=True,
        ready=(ReadyCondition("process", ""),),
        names_log=False,
        files=((name, json.dumps(calls, indent=1, ensure_ascii=False)),),
    )


def _load(node: NodeSpec, container: str, written: Mapping[str, object], world: World) -> Fields:
    fields: Fields = {"package_name": node.package, "plugin_name": node.type}
    fields |= {"node_name": node.name} if node.is_named else {}
    fields |= {"node_namespace": node.namespace.rstrip("/") or "/"} if node.is_placed else {}
    fields["remap_rules"] = [f"{old}:={new}" for old, new in node.remaps]
    fields["parameters"] = [_message(*pair) for pair in _parameters(node, written, world)]
    fields["extra_arguments"] = [_message(*pair) for pair in node.extra]
    return {"service": f"{container}/_container/load_node", "fields": fields, "about": f"loading {node.full_name}"}


def _parameters(node: NodeSpec, written: Mapping[str, object], world: World) -> Iterator[tuple[str, object]]:
    known: list[tuple[str, object]] = []
    for source in node.sources:
        if isinstance(source, ParameterFile):
            text = written.get(source.path)
            sections = _read_sections(world.read_bytes(source.path).decode() if text is None else str(text))
            found = {
                name: value
                for wanted in ("/**", node.full_name)
                for pattern, values in sections.sections
                if pattern == wanted
                for name, value in flatten(values)
            }
            known = list(found.items()) or known  # launch_ros repeats the parameters before a file without any
        else:
            known = list(source.values)
        yield from known


@cache
def _read_sections(text: str) -> ParameterSections:
    from ur.source.foreign.yaml_text import load_yaml  # most files have no components

    return ParameterSections(load_yaml(text))  # one file is for many nodes


def _message(name: str, value: ParamValue | object) -> Fields:
    if isinstance(value, (list, tuple)):
        kinds = {type(each) for each in value}
        mixed = kinds == {int, float}
        number, field = _KINDS.get(float if mixed else next(iter(kinds), str), _KINDS[str])
        items = [float(cast("float", each)) for each in value] if mixed else list(value)
        return {"name": name, "value": {"type": number + _TO_ARRAY + 1, f"{field}_array_value": items}}
    number, field = _KINDS.get(type(value), _KINDS[str])
    if isinstance(value, bytes):
        return {"name": name, "value": {"type": number, "byte_array_value": list(value)}}
    return {"name": name, "value": {"type": number, f"{field}_value": value}}
