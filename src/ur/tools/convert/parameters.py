"""`<param>` and `<rosparam>` of a node as ROS 2 has them."""

import json
import re
from collections.abc import Iterator, Mapping

from ur.launchfile.plan.values.convert import guess_value, read_boolean, read_type
from ur.launchfile.plan.values.yaml_values import YamlProblem, read_yaml
from ur.launchfile.ros2_values import convert_map
from ur.launchfile.syntax import Element, is_eval
from ur.tools.convert.expressions import NotConvertible
from ur.tools.convert.parameter_files import write_value
from ur.tools.convert.texts import convert_text, quote_template
from ur.tools.convert.xml_out import XmlTag

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
