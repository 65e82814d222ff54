"""`<node>` as ROS 2 has it."""

import itertools
import re
from collections.abc import Iterator, Mapping

from ur.launchfile.syntax import Comment, Element
from ur.tools.convert.expressions import NotConvertible
from ur.tools.convert.parameters import convert_inline, convert_param, read_flag
from ur.tools.convert.state import Findings, PlaceInFile, conditions_of, convert_attribute
from ur.tools.convert.texts import convert_text
from ur.tools.convert.xml_out import XmlTag

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
