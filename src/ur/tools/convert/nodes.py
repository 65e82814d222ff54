"""`<node>`, its `<param>` and `<rosparam>`, as ROS 2 has them."""

import itertools
import json
import re
from collections.abc import Iterator, Mapping

from ur.launchfile.plan.values.convert import guess_value, read_boolean, read_type
from ur.launchfile.plan.values.yaml_values import YamlProblem, read_yaml
from ur.launchfile.ros2_values import convert_map
from ur.launchfile.syntax import Comment, Element, is_eval
from ur.tools.convert.expressions import NotConvertible
from ur.tools.convert.parameter_files import write_value
from ur.tools.convert.state import Findings, PlaceInFile, conditions_of, convert_attribute
from ur.tools.convert.texts import convert_text, quote_template
from ur.tools.convert.yaml_out import XmlTag

_TYPES = {"str": "str", "int": "int", "double": "float", "bool": "bool"}
_WORDS = {bool: "bool", int: "int", float: "float", str: "str"}


def convert_param(element: Element) -> list[XmlTag]:
    """The parameter of a node that a `<param>` sets. Raises NotConvertible."""
    attributes = element.attributes
    name = parameter_name(attributes.get("name", ""))
    if "command" in attributes:
        return [_printed(name, convert_text(attributes["command"]), attributes)]
    if "textfile" in attributes:
        command = quote_template(f'cat "{convert_text(attributes["textfile"])}"')
        return [XmlTag("param", {"name": name, "value": f"$(command {command})", "type": "str"})]
    if "binfile" in attributes:
        raise NotConvertible("a binary parameter", "give the path as a text, and let the node read the file")
    value = attributes.get("value", "")
    kind = read_type(attributes.get("type", "auto"))
    if kind == "yaml" and "$(" not in value:
        return list(tags_of({name: read_values(value)}))
    if kind in (None, "auto", "yaml"):
        return [_guessed(name, value)]
    if kind == "bool" and "$(" not in value:
        try:
            value = json.dumps(read_boolean(value))
        except ValueError as problem:
            raise NotConvertible(f"the value '{value}' ({problem})", "ur check explains it") from None
    return [XmlTag("param", {"name": name, "value": convert_text(value), "type": _TYPES[str(kind)]})]


def parameter_name(text: str) -> str:
    """A name as ROS 2 writes it: 'a/b' is 'a.b'."""
    name = convert_text(text)
    return name if "$(" in name else name.strip("~/").replace("/", ".")


def _printed(name: str, command: str, attributes: Mapping[str, str]) -> XmlTag:
    kind = _TYPES.get(str(read_type(attributes.get("type", "auto"))))
    value = f"$(command {quote_template(command)} 'warn')"
    return XmlTag("param", {"name": name, "value": value, **({"type": kind} if kind else {})})


def _guessed(name: str, text: str) -> XmlTag:
    if "$(" in text:
        return XmlTag("param", {"name": name, "value": convert_text(text)})
    value = guess_value(text)
    return XmlTag("param", {"name": name, "value": _written(value, text), "type": _WORDS[type(value)]})


def _written(value: object, text: str) -> str:
    return (
        json.dumps(value) if isinstance(value, bool) else convert_text(text) if isinstance(value, str) else text.strip()
    )


def convert_inline(element: Element) -> list[XmlTag]:
    """The parameters that the text of a `<rosparam>` sets. Raises NotConvertible."""
    value = read_values(element.text)
    path = [part for word in ("ns", "param") for part in element.attributes.get(word, "").split("/") if part]
    if "$(" in "".join(path):
        raise NotConvertible("a name that is computed", "write the names of the parameters")
    for name in reversed(path):
        value = {name: value}
    if not isinstance(value, dict):
        raise NotConvertible("a value without a name", 'add param="NAME"')
    return list(tags_of(value, substitutes=read_flag(element)))


def read_flag(element: Element) -> bool:
    """Test whether the values of a `<rosparam>` hold `$(...)`."""
    return element.attributes.get("subst_value", "false").lower().strip() in ("true", "1")


def read_values(text: str) -> object:
    """The values of a text in YAML. Raises NotConvertible."""
    try:
        return read_yaml(text, reads_angles=True).value
    except YamlProblem as problem:
        raise NotConvertible(str(problem), "ur check explains it") from None


def tags_of(values: Mapping[str, object], *, substitutes: bool = False) -> Iterator[XmlTag]:
    """The tags of parameters."""
    for name, value in convert_map(values).items():
        yield _tag(name, value, substitutes)


def _tag(name: str, value: object, substitutes: bool) -> XmlTag:
    if isinstance(value, dict):
        return XmlTag("param", {"name": name}, [_tag(str(key), each, substitutes) for key, each in value.items()])
    if isinstance(value, list):
        return XmlTag("param", {"name": name, "value": re.sub(r"\\", r"\\\\", write_value(value))})
    if isinstance(value, str):
        if substitutes and ("$(" in value or is_eval(value)):
            return XmlTag("param", {"name": name, "value": convert_text(value)})
        return XmlTag("param", {"name": name, "value": value.replace("\\", "\\\\"), "type": "str"})
    return XmlTag("param", {"name": name, "value": write_value(value), "type": _WORDS[type(value)]})


_RENAMED = {"type": "exec", "ns": "namespace"}
_PLAIN = ("pkg", "type", "name", "ns", "args", "output", "respawn", "launch-prefix")
_TERMINAL = re.compile(r"\s*terminal\s*:")
_ARGUMENT = re.compile(r"\$\(arg\s+(\w+)\s*\)")
_MOST_CONDITIONS = 3
_COUNTERPARTS = {
    "amcl": "nav2_amcl, whose parameters differ",
    "gmapping": "slam_toolbox",
    "map_server": "nav2_map_server, whose nodes have a lifecycle",
    "move_base": "Nav2: include navigation_launch.py of nav2_bringup",
    "nodelet": "a component: <node_container> with <composable_node>",
    "rosbag": '<executable cmd="ros2 bag ..."/>',
    "rosserial_python": "micro_ros_agent",
    "tf": "static_transform_publisher of tf2_ros, whose arguments are named",
}
_RENAMED_NODES = {("rviz", "rviz"): ("rviz2", "rviz2")}


def convert_node(element: Element, scope: PlaceInFile) -> list[XmlTag]:
    """The tag of a node; where tags inside have conditions, one for each case."""
    findings = scope.findings
    inside = [child for child in element.elements if child.name in ("param", "rosparam", "remap", "env")]
    wanted = {id(child): _conditions(child, scope) for child in inside}
    conditions = list(dict.fromkeys(text for each in wanted.values() for text, _ in each))
    if len(conditions) > _MOST_CONDITIONS:
        message = f"{len(conditions)} different conditions inside a <node>"
        findings.add(message, element.span, "write a <node> for each case, and convert again")
        conditions = conditions[:_MOST_CONDITIONS]
    _name_differences(element, scope)
    attributes = _attributes_of(element, findings)
    parts = [(child, _convert_child(child, scope)) for child in _parameters_last(inside)]
    own = conditions_of(element, findings)
    variants = []
    for values in itertools.product((True, False), repeat=len(conditions)):
        case = dict(zip(conditions, values, strict=True))
        kept = [made for child, made in parts if all(case.get(text) is value for text, value in wanted[id(child)])]
        node = XmlTag("node", {**attributes, **own}, [*scope.private, *itertools.chain.from_iterable(kept)])
        variants.append(_wrap(node, case))
    return variants


def _conditions(child: Element, scope: PlaceInFile) -> list[tuple[str, bool]]:
    """The conditions of a tag inside a node, and whether each has to hold.

    An argument that may be an empty list sets nothing then: ROS 2 has no empty lists.
    """
    found = [_canonical(*each) for each in conditions_of(child, scope.findings).items()]
    empty = _ARGUMENT.fullmatch(child.text.strip()) if child.name == "rosparam" else None
    default = scope.defaults.get(empty[1], "").strip() if empty else ""
    if empty and default in ("[]", "{}"):
        found.append((f"$(eval \"'$(var {empty[1]})' == '{default}'\")", False))
    return found


def _canonical(name: str, text: str) -> tuple[str, bool]:
    """Normalise a condition: return it without negation, and whether it has to hold."""
    simple = text.count(" != ") == 1 and not any(word in text for word in (" and ", " or ", " if ", " not "))
    return (text.replace(" != ", " == "), name != "if") if simple else (text, name == "if")


def _wrap(node: XmlTag, case: Mapping[str, bool]) -> XmlTag:
    """A node with the conditions of a case: one of its own, and those of groups around it."""
    wrapped = node
    for text, value in reversed(list(case.items())):
        if "if" in wrapped.attributes or "unless" in wrapped.attributes:
            wrapped = XmlTag("group", {}, [wrapped])
        wrapped.attributes["if" if value else "unless"] = text
    return wrapped


def _parameters_last(inside: list[Element]) -> Iterator[Element]:
    """The tags in the order in which they count: those of files before single parameters, as for roslaunch."""
    for names in (("env", "remap"), ("rosparam",), ("param",)):
        yield from (child for child in inside if child.name in names)


def _attributes_of(element: Element, findings: Findings) -> dict[str, str]:
    written = {name: convert_attribute(element, name, findings) for name in _PLAIN if name in element.attributes}
    attributes = {_RENAMED.get(name, name): value for name, value in written.items() if value}
    known = _RENAMED_NODES.get((attributes.get("pkg", ""), attributes.get("exec", "")))
    if known:
        attributes["pkg"], attributes["exec"] = known
    delay = element.attributes.get("respawn_delay")
    if delay is not None:
        try:
            attributes["respawn_delay"] = str(float(delay))
        except ValueError:
            reason = "is computed" if "$(" in delay else f"is '{delay}'"
            message = f"respawn_delay {reason}, expected a number for ros2 launch"
            findings.add(message, element.value_span("respawn_delay"), "write a number")
    return attributes | _required(element, findings)


def _required(element: Element, findings: Findings) -> dict[str, str]:
    text = element.attributes.get("required", "false")
    if "$(" in text:
        span = element.value_span("required")
        findings.add("required= is computed, expected true or false for ros2 launch", span, "write true or false")
        return {}
    return {"on_exit": "shutdown"} if text.lower().strip() in ("true", "1") else {}


def _name_differences(element: Element, scope: PlaceInFile) -> None:
    """Name what a node of ROS 2 has not."""
    findings = scope.findings
    machine = scope.resolve(element.attributes.get("machine", "localhost"))
    if machine not in ("localhost", ""):
        findings.machines.append(element.value_span("machine"))
    if "cwd" in element.attributes:
        help_ = 'write the folder: cwd="/home/..."; without it the folder is that of ros2 launch'
        findings.add("cwd= names no folder of ROS 2", element.value_span("cwd"), help_)
    package, program = (scope.resolve(element.attributes.get(name, "")) for name in ("pkg", "type"))
    if package in _COUNTERPARTS:
        span = element.value_span("pkg")
        findings.add(f"package '{package}' is of ROS 1", span, f"its counterpart is {_COUNTERPARTS[package]}")
    if any(isinstance(each, Comment) and _TERMINAL.match(each.text) for each in element.children):
        help_ = f"leave it out, and run it in a terminal of its own: ros2 run {package} {program}"
        findings.add("the node needs a terminal, which ros2 launch does not give", element.span, help_)


def _convert_child(child: Element, scope: PlaceInFile) -> list[XmlTag]:
    try:
        if child.name == "remap":
            return [remap_tag("remap", child)]
        if child.name == "env":
            return [XmlTag("env", {name: convert_text(child.attributes.get(name, "")) for name in ("name", "value")})]
        return convert_param(child) if child.name == "param" else _convert_rosparam(child, scope)
    except NotConvertible as problem:
        scope.findings.add(f"{problem} cannot be converted", child.span, problem.help)
        return []


def remap_tag(name: str, element: Element) -> XmlTag:
    """A remap as ROS 2 writes names: '~goal' is '~/goal'. Raises NotConvertible."""
    texts = (convert_text(element.attributes.get(end, "")) for end in ("from", "to"))
    source, target = (f"~/{text[1:].lstrip('/')}" if text.startswith("~") else text for text in texts)
    return XmlTag(name, {"from": source, "to": target})


def _convert_rosparam(element: Element, scope: PlaceInFile) -> list[XmlTag]:
    command = element.attributes.get("command", "load")
    if command != "load":
        raise NotConvertible(
            f'<rosparam command="{command}">', "each node of ROS 2 keeps its own parameters: remove it"
        )
    file = element.attributes.get("file")
    if file is None:
        return convert_inline(element)
    if element.attributes.get("ns") or element.attributes.get("param"):
        raise NotConvertible("a file of parameters below a name", "write the name into the file")
    path = convert_text(file)
    substitutes = read_flag(element)
    written = scope.resolve(file)
    findings = scope.findings
    findings.files[written] = findings.files.get(written, False) or substitutes
    return [XmlTag("param", {"from": path, **({"allow_substs": "true"} if substitutes else {})})]
