"""The tags of a launch file as ROS 2 has them.

An `<include>` of ROS 1 hands over its `<arg>`s and nothing else, and changes nothing for the tags after it. For ROS 2
that is a `<group>` which forwards nothing but its `<keep>`s.
"""

import re
from collections.abc import Callable

from ur.launchfile.plan.specs import LOCAL_ADDRESSES
from ur.launchfile.syntax import Comment, Element
from ur.tools.convert.expressions import NotConvertible
from ur.tools.convert.nodes import convert_node, convert_param, remap_tag
from ur.tools.convert.state import Findings, PlaceInFile, conditions_of, convert_attribute
from ur.tools.convert.texts import convert_text
from ur.tools.convert.yaml_out import XmlTag, write_xml

_DOCUMENTED = re.compile(r"\s*([A-Za-z_]\w*)\s*:\s*(.*\S)\s*\Z", re.DOTALL)
_DIRECTIVE = re.compile(r"\s*(ur|terminal|ready)\s*:")
_NAMESPACE = {"name": "ros_namespace", "value": "$(var ros_namespace '')"}
_FILE = "included_file"
_DESCRIBED = ("robot_state_publisher", "joint_state_publisher", "rviz")
_Made = tuple[list[XmlTag], PlaceInFile]


def convert_body(element: Element, scope: PlaceInFile) -> list[XmlTag]:
    """The tags inside `<launch>` or `<group>`."""
    made: list[XmlTag] = []
    for child in element.children:
        if isinstance(child, Comment):
            made += _convert_comment(child, scope)
        else:
            tags, scope = _convert_tag(child, scope, element)
            made += tags
    return made


def _convert_comment(comment: Comment, scope: PlaceInFile) -> list[XmlTag]:
    found = _DOCUMENTED.match(comment.text)
    if found and found[1] in scope.arguments:
        tag = scope.arguments.pop(found[1])
        if tag.name == "arg":
            tag.attributes["description"] = " ".join(found[2].split())
            return []
    return [] if _DIRECTIVE.match(comment.text) else [XmlTag("", comment=comment.text)]


def _convert_tag(element: Element, scope: PlaceInFile, parent: Element) -> _Made:
    handler = _HANDLERS.get(element.name)
    if handler is None:
        help_ = "<test> becomes a test of launch_testing" if element.name == "test" else "remove it"
        scope.findings.add(f"<{element.name}> has no counterpart in ROS 2", element.span, help_)
        return [], scope
    try:
        return handler(element, scope, parent)
    except NotConvertible as problem:
        scope.findings.add(f"{problem} cannot be converted", element.span, problem.help)
        return [], scope


def _arg(element: Element, scope: PlaceInFile, _parent: Element) -> _Made:
    attributes = element.attributes
    name = attributes.get("name", "")
    conditions = conditions_of(element, scope.findings)
    if "value" in attributes:
        tag = XmlTag("let", {"name": name, "value": _required_text(element, "value"), **conditions})
    else:
        default = {"default": _required_text(element, "default")} if "default" in attributes else {}
        tag = XmlTag("arg", {"name": name, **default, **conditions})
    scope.arguments[name] = tag
    if written := attributes.get("value", attributes.get("default")):
        scope.defaults[name] = written
    if "doc" in attributes and tag.name == "arg":
        tag.attributes["description"] = attributes["doc"]
    return [tag], scope


def _required_text(element: Element, name: str) -> str:
    return convert_text(element.attributes.get(name, ""))


def _include(element: Element, scope: PlaceInFile, _parent: Element) -> _Made:
    passes_all = element.attributes.get("pass_all_args", "false").lower().strip() in ("true", "1")
    file = _required_text(element, "file")
    passed = {
        each.attributes.get("name", ""): _passed_value(each, scope) for each in element.elements if each.name == "arg"
    }
    group = XmlTag("group", {} if passes_all else {"forwarding": "false"})
    if passes_all:
        values = passed
    else:
        group.children.append(XmlTag("keep", dict(_NAMESPACE)))
        group.children += [XmlTag("keep", {"name": name, "value": value}) for name, value in passed.items()]
        values = {name: f"$(var {name})" for name in passed}
        if "$(var " in file or "$(eval " in file:
            group.children.append(XmlTag("keep", {"name": _FILE, "value": file}))
            file = f"$(var {_FILE})"
        group.children += _handed_on(element, scope)
    group.children += _environment(element, scope)
    include = XmlTag("include", {"file": file})
    include.children = [XmlTag("arg", {"name": name, "value": value}) for name, value in values.items()]
    group.children.append(include)
    namespace = convert_attribute(element, "ns", scope.findings)
    if namespace:
        group = XmlTag("group", {}, [XmlTag("push_ros_namespace", {"namespace": namespace}), group])
    group.attributes |= conditions_of(element, scope.findings)
    return [group], scope


def _passed_value(element: Element, scope: PlaceInFile) -> str:
    if "if" in element.attributes or "unless" in element.attributes:
        message = "a condition on an argument that is passed"
        scope.findings.add(message, element.span, "write an <include> for each case, and convert again")
    return _required_text(element, "value" if "value" in element.attributes else "default")


def _handed_on(element: Element, scope: PlaceInFile) -> list[XmlTag]:
    """Remaps and variables of this file, for the file that is included."""
    if any("$(var " in value for tag in scope.inherited for value in tag.attributes.values()):
        help_ = "pass the name as an argument to the included file, and remap it there"
        scope.findings.add("a remap or variable with an argument holds for an included file", element.span, help_)
    return [tag for tag in scope.inherited if not any("$(var " in value for value in tag.attributes.values())]


def _environment(element: Element, scope: PlaceInFile) -> list[XmlTag]:
    made = []
    for each in element.elements:
        if each.name == "env":
            made += _env(each, scope, element)[0]
    return made


def _group(element: Element, scope: PlaceInFile, _parent: Element) -> _Made:
    group = XmlTag("group", conditions_of(element, scope.findings))
    namespace = convert_attribute(element, "ns", scope.findings)
    if namespace:
        group.children.append(XmlTag("push_ros_namespace", {"namespace": namespace}))
    group.children += convert_body(element, scope)
    return ([group] if group.children else []), scope


def _node(element: Element, scope: PlaceInFile, _parent: Element) -> _Made:
    return convert_node(element, scope), scope


def _remap(element: Element, scope: PlaceInFile, _parent: Element) -> _Made:
    tag = remap_tag("set_remap", element)
    tag.attributes |= conditions_of(element, scope.findings)
    return [tag], scope.with_inherited(tag)


def _env(element: Element, scope: PlaceInFile, _parent: Element) -> _Made:
    attributes = {name: _required_text(element, name) for name in ("name", "value")}
    tag = XmlTag("set_env", attributes | conditions_of(element, scope.findings))
    return [tag], scope.with_inherited(tag)


def _machine(element: Element, scope: PlaceInFile, _parent: Element) -> _Made:
    address = element.attributes.get("address", "")
    if address not in LOCAL_ADDRESSES:
        help_ = "start a launch file on each computer"
        scope.findings.add("<machine> has no counterpart: ros2 launch starts nothing elsewhere", element.span, help_)
    return [], scope


def _param(element: Element, scope: PlaceInFile, parent: Element) -> _Made:
    name = element.attributes.get("name", "")
    conditions = conditions_of(element, scope.findings)
    if name.startswith("~") and not conditions:
        return [], scope.with_private(convert_param(element))
    if name.lstrip("/") == "use_sim_time":
        value = _required_text(element, "value")
        help_ = "where other files start nodes, put <set_use_sim_time> into the first launch file"
        scope.findings.add("a parameter of all nodes: it holds for the nodes of this file only", element.span, help_)
        return [XmlTag("set_parameter", {"name": "use_sim_time", "value": value, **conditions})], scope
    if name.lstrip("/") == "robot_description" and not conditions:
        nodes = [each for each in parent.elements if each.attributes.get("type") in _DESCRIBED]
        if nodes:
            return [], scope.with_private(convert_param(element))
    raise _global(f"the global parameter '{name}'")


def _rosparam(_element: Element, _scope: PlaceInFile, _parent: Element) -> _Made:
    raise _global("<rosparam> outside of a <node>")


def _global(what: str) -> NotConvertible:
    return NotConvertible(f"{what} (ROS 2 has no global ones)", "move it into each <node> that reads it")


_HANDLERS: dict[str, Callable[[Element, PlaceInFile, Element], _Made]] = {
    "arg": _arg,
    "env": _env,
    "group": _group,
    "include": _include,
    "machine": _machine,
    "node": _node,
    "param": _param,
    "remap": _remap,
    "rosparam": _rosparam,
}


def convert_launch(launch: Element, before: tuple[Comment, ...], findings: Findings) -> XmlTag:
    """The whole file. `before` are the comments outside of its element."""
    comments = [tag for comment in before for tag in _convert_comment(comment, PlaceInFile(findings))]
    scope = PlaceInFile(findings)
    root = XmlTag("launch", {}, [*comments, *convert_body(launch, scope)])
    for name, written in scope.defaults.items():
        if "'" in written:
            _quote_thrice(root, name)
    if not any(element.name == "include" for element in launch.elements):
        text = write_xml(root)
        root.children = [tag for child in root.children for tag in (*_excuse(child, text), child)]
    return root


def _excuse(tag: XmlTag, text: str) -> tuple[XmlTag, ...]:
    """Return a comment before an argument that only parts without a counterpart used: other files may pass it."""
    name = tag.attributes.get("name", "")
    if tag.name != "arg" or len(re.findall(rf"(?<!\w){re.escape(name)}(?!\w)", text)) > 1:
        return ()
    return (XmlTag("", comment="ur: ignore unused-argument: what used it has no counterpart in ROS 2"),)


def _quote_thrice(tag: XmlTag, argument: str) -> None:
    """Let the text of an argument hold apostrophes where expressions have it; the blank keeps the last one apart."""
    quoted = f"'$(var {argument})'"
    for name, value in tag.attributes.items():
        if "$(eval " in value:
            tag.attributes[name] = value.replace(quoted, f"'''$(var {argument}) '''[:-1]")
    for child in tag.children:
        _quote_thrice(child, argument)
