"""Launch files in XML and YAML: their entities, and the objects of the launch API that these stand for.

Both languages have the same entities; they differ in how attributes and inner entities are written.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import yaml

from ur.launchfile.ros2.grammar import parse_command, parse_text
from ur.launchfile.ros2.model import Description, DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.parameters import coerce
from ur.launchfile.syntax import Element, parse_launch_file
from ur.source.file import SourceFile, Span
from ur.source.foreign.yaml_text import compose_yaml, load_yaml
from ur.source.suggest import did_you_mean


@dataclass(frozen=True, slots=True)
class Entity:
    """An entity: its type, its attributes with their spans, and the entities inside."""

    name: str
    span: Span
    attributes: Mapping[str, tuple[object, Span]]
    inner: tuple[Entity, ...] = ()
    names: Mapping[str, Span] = field(default_factory=dict)

    @property
    def is_yaml(self) -> bool:
        """True if attributes have the types of YAML; those of XML are texts."""
        return not self.span.file.path.endswith((".xml", ".launch"))

    def text(self, name: str) -> str | None:
        """Return an attribute as it was written."""
        found = self.attributes.get(name)
        return None if found is None else str(found[0]) if not isinstance(found[0], bool) else str(found[0]).lower()


@dataclass(frozen=True, slots=True)
class Tag:
    """A type of entity: attributes with the arguments they become, inner entities, and where inner actions go."""

    kind: str
    attributes: Mapping[str, tuple[str, str]]
    lists: Mapping[str, str]
    actions: str
    required: frozenset[str]


def read_entities(path: str, text: str) -> Description:
    """Read a launch file in XML or YAML. Never raises for its content."""
    problems: list[DescriptionProblem] = []
    is_yaml = path.endswith((".yaml", ".yml"))
    root = _read_yaml(path, text, problems) if is_yaml else _read_xml(path, text, problems)
    if root is None:
        return Description(path, None, tuple(problems))
    if root.name != "launch":
        problems.append(
            DescriptionProblem(
                f"the root is <{root.name}>, expected <launch>", "launch-element", root.span, None, root.name
            )
        )
        return Description(path, None, tuple(problems))

    def report(problem: DescriptionProblem) -> None:
        problems.append(problem)

    actions = list(_Maker(report).make_all(root.inner))
    return Description(path, Made("LaunchDescription", {"initial_entities": actions}, root.span), tuple(problems))


# -- XML and YAML to entities


def _read_xml(path: str, text: str, problems: list[DescriptionProblem]) -> Entity | None:
    parsed = parse_launch_file(path, text.encode())
    problems.extend(
        DescriptionProblem(found.message, found.rule, found.span, found.help, found.subject)
        for found in parsed.diagnostics
        if found.rule not in ("wrong-ros-version", "launch-element")
    )
    return _from_element(parsed.root) if parsed.root is not None and not problems else None


def _from_element(element: Element) -> Entity:
    attributes = {name: (value, element.value_span(name)) for name, value in element.attributes.items()}
    names = {name: element.name_span(name) for name in element.attributes}
    inner = tuple(_from_element(each) for each in element.elements)
    return Entity(element.name, element.span, attributes, inner, names)


def _read_yaml(path: str, text: str, problems: list[DescriptionProblem]) -> Entity | None:
    source = SourceFile(path, text)
    try:
        node = compose_yaml(text)
    except (yaml.YAMLError, ValueError) as problem:
        mark = getattr(problem, "problem_mark", None)
        at = min(mark.index if mark is not None else 0, len(text))
        reason = getattr(problem, "problem", None) or str(problem)
        span = Span(source, at, min(at + 1, len(text)))
        problems.append(DescriptionProblem(f"not YAML: {reason}", "bad-yaml", span, "correct this line"))
        return None
    whole = Span(source, 0, min(1, len(text)))
    if not isinstance(node, yaml.MappingNode) or not node.value:
        problems.append(
            DescriptionProblem("no entity 'launch', expected one at the top", "launch-element", whole, "launch:")
        )
        return None
    key, value = node.value[0]
    return _from_node(source, str(key.value), key, value)


def _from_node(source: SourceFile, name: str, key: yaml.Node, value: yaml.Node) -> Entity:
    attributes: dict[str, tuple[object, Span]] = {}
    inner: list[Entity] = []
    names: dict[str, Span] = {}
    if isinstance(value, yaml.SequenceNode):
        inner += _children(source, value)
    elif isinstance(value, yaml.MappingNode):
        for part, each in value.value:
            word = str(part.value)
            if word == "children" and isinstance(each, yaml.SequenceNode):
                inner += _children(source, each)
            elif isinstance(each, yaml.SequenceNode) and each.value and isinstance(each.value[0], yaml.MappingNode):
                inner += [_from_node(source, word, part, item) for item in each.value]
            else:
                attributes[word] = (_value_of(each), _span_of(source, each))
                names[word] = _span_of(source, part)
    return Entity(name, _span_of(source, key), attributes, tuple(inner), names)


def _children(source: SourceFile, node: yaml.SequenceNode) -> Iterator[Entity]:
    for item in node.value:
        if isinstance(item, yaml.MappingNode) and item.value:
            key, value = item.value[0]
            yield _from_node(source, str(key.value), key, value)


def _value_of(node: yaml.Node) -> object:
    if isinstance(node, yaml.SequenceNode):
        return [_value_of(each) for each in node.value]
    if isinstance(node, yaml.ScalarNode):
        if node.style in ("'", '"', "|", ">"):
            return str(node.value)
        return load_yaml(str(node.value)) if node.value else ""
    return ""


def _span_of(source: SourceFile, node: yaml.Node) -> Span:
    start, end = node.start_mark, node.end_mark
    return Span(source, start.index if start else 0, end.index if end else 0)


# -- entities to objects

# ATTRIBUTE[=ARGUMENT][:MODE][!], where MODE is how it is read: text with substitutions unless given, plain text, a
# command line, flag, number, YAML. After `|` the inner entities, after `>` the argument for inner actions.
_PROCESS = (
    "cwd launch-prefix=prefix output respawn respawn_max_retries:number respawn_delay:number sigkill_timeout:number "
    "sigterm_timeout:number shell:flag emulate_tty:flag on_exit:exit"
)
_NODE = f"pkg=package exec=executable! args=arguments:command ros_args=ros_arguments:command exec_name {_PROCESS}"
_IN_NODE = "| param=parameters remap=remappings env=additional_env"
_COMPONENT = "pkg=package! plugin! name! namespace | param=parameters remap=remappings extra_arg=extra_arguments"
_COMPONENTS = "composable_node=composable_node_descriptions composable_lifecycle_node=composable_node_descriptions"
_ENTITIES = {
    "append_env": "AppendEnvironmentVariable name! value! prepend:flag separator",
    "arg": "DeclareLaunchArgument name:plain! default=default_value description:plain | choice=choices",
    "composable_lifecycle_node": f"ComposableLifecycleNode autostart:flag {_COMPONENT}",
    "composable_node": f"ComposableNode {_COMPONENT}",
    "executable": f"ExecuteProcess cmd:command! name {_PROCESS} | env=additional_env",
    "for": "ForLoop len=length! name:plain! > actions",
    "for_each": "ForEach values=input_values! > actions",
    "group": "GroupAction scoped:flag forwarding:flag | keep=launch_configurations > actions",
    "include": "IncludeLaunchDescription file=launch_description_source! | arg=launch_arguments let=launch_arguments",
    "let": "SetLaunchConfiguration name! value!",
    "lifecycle_node": f"LifecycleNode name! namespace! autostart:flag {_NODE} {_IN_NODE}",
    "lifecycle_transition": "LifecycleTransition lifecycle_node_names:command transition_ids:command "
    "transition_labels:command",
    "load_composable_node": f"LoadComposableNodes target=target_container! | {_COMPONENTS}",
    "log": "LogInfo message=msg! level",
    "log_debug": "LogDebug message=msg!",
    "log_error": "LogError message=msg!",
    "log_info": "LogInfo message=msg!",
    "log_warning": "LogWarning message=msg!",
    "node": f"Node name namespace {_NODE} {_IN_NODE}",
    "node_container": f"ComposableNodeContainer name! namespace! {_NODE} {_IN_NODE} {_COMPONENTS}",
    "push_ros_namespace": "PushRosNamespace namespace!",
    "reset": "ResetLaunchConfigurations | keep=launch_configurations",
    "reset_env": "ResetEnvironment",
    "ros_timer": "RosTimer period:number! > actions",
    "set_env": "SetEnvironmentVariable name! value!",
    "set_parameter": "SetParameter name! value:yaml!",
    "set_parameters_from_file": "SetParametersFromFile filename! node_name",
    "set_remap": "SetRemap from=src! to=dst!",
    "set_ros_log_dir": "SetROSLogDir new_log_dir=log_dir",
    "set_use_sim_time": "SetUseSimTime value:yaml!",
    "shutdown": "Shutdown reason",
    "timer": "TimerAction period:number! cancel_on_shutdown:flag > actions",
    "unset": "UnsetLaunchConfiguration name!",
    "unset_env": "UnsetEnvironmentVariable name!",
}


def _read_tag(text: str) -> Tag:
    before, _, actions = text.partition(" > ")
    written, _, inner = before.partition(" | ")
    kind, *words = written.split()
    attributes = {"if": ("", ""), "unless": ("", "")}
    for word in words:
        name, _, mode = word.rstrip("!").partition(":")
        attribute, _, target = name.partition("=")
        attributes[attribute] = (target or attribute, mode or "text")
    required = {re.split("[=:!]", word)[0] for word in words if word.endswith("!")}
    lists = dict(each.split("=") for each in inner.split())
    return Tag(kind, attributes, lists, actions, frozenset(required))


TAGS = {name: _read_tag(text) for name, text in _ENTITIES.items()}
_SPELLINGS = {"push-ros-namespace": "push_ros_namespace"}
_OF_ROS1 = {
    "machine": "ROS 2 starts nodes on one computer",
    "param": "write it inside <node>, or as <set_parameter>",
    "rosparam": "write <param from=...> inside <node>",
    "remap": "write it inside <node>, or as <set_remap>",
    "env": "write <set_env>",
    "test": "write a test with launch_testing",
}
_ROS1_ATTRIBUTES = {
    "type": "exec",
    "ns": "namespace",
    "value": "default",
    "doc": "description",
    "launch_prefix": "launch-prefix",
}


class _Maker:
    def __init__(self, report: Callable[[DescriptionProblem], None]) -> None:
        self._report = report

    def make_all(self, entities: tuple[Entity, ...]) -> Iterator[Made | Unknown]:
        for entity in entities:
            try:
                made = self._make(entity)
            except DescriptionProblem as problem:
                self._report(problem)
                continue
            yield made

    def _make(self, entity: Entity) -> Made | Unknown:
        tag = TAGS.get(_SPELLINGS.get(entity.name, entity.name))
        if tag is None:
            near = did_you_mean(entity.name, TAGS)
            if near is None and entity.name not in _OF_ROS1:
                return Unknown(f"<{entity.name}> is an entity of a package, what it starts", entity.span)
            help_ = _OF_ROS1.get(entity.name, f"did you mean <{near}>?")
            message = f"<{entity.name}> is not an entity of ROS 2, expected one"
            raise DescriptionProblem(message, "unknown-tag", entity.span, help_, entity.name)
        values: dict[str, object] = {}
        places: dict[str, Span] = {}
        for name, (value, span) in entity.attributes.items():
            if name in tag.attributes:
                target, mode = tag.attributes[name]
                if target:
                    values[target] = self._read(value, mode, span)
                    places[target] = span
            elif not name.endswith("-sep"):
                self._report_attribute(entity, tag, name, span)
        for name in sorted(tag.required - set(entity.attributes)):
            raise self._missing(entity, name)
        self._read_condition(entity, values, places)
        self._read_inner(entity, tag, values, places)
        return Made(tag.kind, values, entity.span, places)

    def _report_attribute(self, entity: Entity, tag: Tag, name: str, span: Span) -> None:
        of_ros1 = _ROS1_ATTRIBUTES.get(name)
        near = of_ros1 if of_ros1 in tag.attributes else did_you_mean(name, tag.attributes)
        help_ = f"write {near}=" if near else f"it has: {', '.join(sorted(tag.attributes))}"
        message = f"<{entity.name}> has no attribute '{name}', expected one that it has"
        self._report(DescriptionProblem(message, "unknown-attribute", entity.names.get(name, span), help_, name))

    def _missing(self, entity: Entity, name: str) -> DescriptionProblem:
        message = f"<{entity.name}> has no attribute '{name}', expected it"
        return DescriptionProblem(message, "missing-attribute", entity.span, f'add {name}="..."', name)

    def _read_inner(self, entity: Entity, tag: Tag, values: dict[str, object], places: dict[str, Span]) -> None:
        for name, target in tag.lists.items():
            listed = [each for each in entity.inner if each.name == name]
            if listed:
                values[target] = self._read_list(target, listed, values.get(target))
                places.setdefault(target, listed[0].span)
        others = tuple(each for each in entity.inner if each.name not in tag.lists)
        if tag.kind in ("ForEach", "ForLoop"):
            values["function"] = _Loop(tuple(self.make_all(others)), entity.text("name") or "", entity.span)
        elif tag.actions:
            values[tag.actions] = list(self.make_all(others))
        else:
            known = ", ".join(f"<{name}>" for name in tag.lists) or "none"
            for each in others:
                message = f"<{entity.name}> has <{each.name}> inside, expected {known}"
                help_ = _OF_ROS1.get(each.name, f"it has: {known}")
                self._report(DescriptionProblem(message, "unknown-tag", each.span, help_, each.name))

    def _read_condition(self, entity: Entity, values: dict[str, object], places: dict[str, Span]) -> None:
        given = [name for name in ("if", "unless") if name in entity.attributes]
        if len(given) == 2:
            raise DescriptionProblem("'if' and 'unless' at once, expected one", "bad-condition", entity.names["unless"])
        for name in given:
            span = entity.attributes[name][1]
            kind = "IfCondition" if name == "if" else "UnlessCondition"
            text = parse_text(entity.text(name) or "", span)
            places["condition"] = span
            values["condition"] = Made(kind, {"predicate_expression": text}, span, {"predicate_expression": span})

    def _read(self, value: object, mode: str, span: Span) -> object:
        if mode == "plain":
            return "".join(part for part in parse_text(str(value), span) if isinstance(part, str))
        if mode in ("flag", "number") and not isinstance(value, str):
            return value
        text = str(value).lower() if isinstance(value, bool) else str(value)
        if mode == "command":
            return parse_command(text, span)
        if mode == "exit":
            if text != "shutdown":
                raise DescriptionProblem(f"on_exit is '{text}', expected 'shutdown'", "bad-choice", span, None, text)
            return Made("Shutdown", {}, span)
        parts = parse_text(text, span)
        if mode == "yaml":  # texts of a substitution have YAML's types, those of a list are texts
            return [Made("TextSubstitution", {"text": each}, span) if isinstance(each, str) else each for each in parts]
        return parts

    def _read_list(self, target: str, listed: list[Entity], known: object) -> object:
        if target == "parameters":
            return [self._read_parameter(each) for each in listed]
        if target == "remappings":
            return [(self._text(each, "from"), self._text(each, "to")) for each in listed]
        if target in ("additional_env", "launch_configurations"):
            return {_key(self._text(each, "name")): self._text(each, "value") for each in listed}
        if target == "launch_arguments":
            pairs = [(self._text(each, "name"), self._text(each, "value")) for each in listed]
            return [*(known if isinstance(known, list) else []), *pairs]
        if target == "choices":
            return [str(each.attributes["value"][0]) for each in listed if "value" in each.attributes]
        if target == "extra_arguments":
            return [{_key(self._text(each, "name")): self._typed(each)} for each in listed]
        return [*(known if isinstance(known, list) else []), *self.make_all(tuple(listed))]

    def _text(self, entity: Entity, name: str) -> list[str | Made]:
        if name not in entity.attributes:
            raise self._missing(entity, name)
        return parse_text(entity.text(name) or "", entity.attributes[name][1])

    def _read_parameter(self, entity: Entity) -> object:
        if "from" in entity.attributes:
            span = entity.attributes["from"][1]
            values: dict[str, object] = {"param_file": self._text(entity, "from")}
            if "allow_substs" in entity.attributes:
                values["allow_substs"] = entity.text("allow_substs") == "true"
            return Made("ParameterFile", values, entity.span, {"param_file": span})
        return self._nested([entity])

    def _nested(self, entities: list[Entity]) -> dict[object, object]:
        found: dict[object, object] = {}
        for entity in entities:
            name = _key(self._text(entity, "name"))
            inner = [each for each in entity.inner if each.name == "param"]
            if inner and "value" in entity.attributes:
                raise DescriptionProblem(
                    "a parameter has a value and inner parameters, expected one of them", "bad-param-value", entity.span
                )
            if not inner and "value" not in entity.attributes:
                raise DescriptionProblem(
                    "a parameter has no value, expected one, or inner parameters",
                    "missing-attribute",
                    entity.span,
                    'add value="..."',
                )
            found[name] = self._nested(inner) if inner else self._typed(entity)
        return found

    def _typed(self, entity: Entity) -> object:
        value, span = entity.attributes["value"]
        name, identifier, separator = entity.text("name") or "", entity.text("type"), entity.text("value-sep")
        if identifier not in VALUE_TYPES:
            message = f"the type is '{identifier}', expected one of {', '.join(filter(None, VALUE_TYPES))}"
            raise DescriptionProblem(message, "bad-param-value", entity.attributes["type"][1], None, identifier or "")
        kind = VALUE_TYPES[identifier]
        if not entity.is_yaml:  # its attributes are texts
            if separator:
                item = getattr(kind, "__args__", (kind,))[0]
                value = [_coerce(part, item, name, span) for part in str(value).split(separator)]
            else:
                value = _coerce(str(value), kind, name, span)
        parsed = [_fill(each, span) for each in value] if isinstance(value, list) else _fill(value, span)
        return Made("ParameterValue", {"value": parsed, "value_type": kind}, span, {"value": span})


VALUE_TYPES: Mapping[str | None, Any] = {
    None: None,
    **{kind.__name__: kind for kind in (str, int, float, bool)},
    **{f"list_of_{kind.__name__}": list[kind] for kind in (str, int, float, bool)},  # type: ignore[valid-type]
    "yaml": None,
}


def _coerce(text: str, kind: object, name: str, span: Span) -> object:
    """Return an attribute as a value of a type; the text itself if substitutions may make it one."""
    try:
        return coerce(text, kind, name, span)
    except DescriptionProblem:
        if getattr(kind, "__args__", None) is None and ("$(" in text or not _is_yaml(text)):
            return text
        raise


def _is_yaml(text: str) -> bool:
    try:
        load_yaml(text)
    except ValueError:
        return False
    return True


def _fill(value: object, span: Span) -> object:
    if not isinstance(value, str):
        return value
    parts = parse_text(value, span)
    return parts[0] if len(parts) == 1 and isinstance(parts[0], str) else parts


def _key(parts: list[str | Made]) -> object:
    return parts[0] if len(parts) == 1 else tuple(parts)


@dataclass(frozen=True, slots=True)
class _Loop:
    """The actions inside a loop of XML or YAML, which substitutions give each round's values."""

    actions: tuple[Made | Unknown, ...]
    name: str
    span: Span

    def run(self, arguments: list[object], keywords: dict[str, Any]) -> list[object]:
        """Return the actions of a round, inside of what sets its variables."""
        variables = {**keywords, **({self.name: str(arguments[0])} if arguments else {})}
        return [Made("LoopRound", {"variables": variables, "actions": list(self.actions)}, self.span)]
