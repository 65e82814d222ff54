"""A reader of launch files of ROS 2 in XML, after the documentation of `launch`: the nodes that one starts.

It knows what `ur convert` writes, and refuses any other tag, attribute and substitution as `ros2 launch` does.
"""

from __future__ import annotations

import math
import os
import re
import shlex
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from xml.etree import ElementTree

import yaml

CONDITIONS = {"if", "unless"}
ALLOWED = {
    "arg": {"name", "default", "description"},
    "env": {"name", "value"},
    "group": {"forwarding"},
    "include": {"file"},
    "keep": {"name", "value"},
    "let": {"name", "value"},
    "node": {
        *("pkg", "exec", "name", "namespace", "args", "output", "respawn", "respawn_delay", "launch-prefix"),
        "on_exit",
    },
    "param": {"name", "value", "type", "from", "allow_substs"},
    "push_ros_namespace": {"namespace"},
    "remap": {"from", "to"},
    "set_env": {"name", "value"},
    "set_parameter": {"name", "value"},
    "set_remap": {"from", "to"},
}
WITHOUT_CONDITION = {"env", "keep", "param", "remap"}
TYPES: Mapping[str, Callable[[str], object]] = {"str": str, "int": int, "float": float}


@dataclass
class LaunchedNode2:
    """A node that is started."""

    name: str
    package: str
    program: str
    args: list[str]
    options: dict[str, str]
    remaps: list[tuple[str, str]]
    environment: dict[str, str]
    parameters: dict[str, object]


@dataclass
class LaunchContext:
    """What is in force: configurations, namespace and all that a group brings back at its end."""

    variables: dict[str, str]
    environment: dict[str, str] = field(default_factory=dict)
    remaps: list[tuple[str, str]] = field(default_factory=list)
    parameters: dict[str, object] = field(default_factory=dict)

    def copy(self) -> LaunchContext:
        return LaunchContext(dict(self.variables), dict(self.environment), list(self.remaps), dict(self.parameters))


class Ros2LaunchReader:
    """Reads files from `texts`, and others from the disk; `packages` are the share folders of packages."""

    def __init__(self, texts: Mapping[str, str], packages: Mapping[str, str]) -> None:
        self.texts = texts
        self.packages = packages

    def read(self, path: str, arguments: Mapping[str, str]) -> list[LaunchedNode2]:
        return list(self._file(path, LaunchContext(dict(arguments))))

    def _file(self, path: str, context: LaunchContext) -> Iterator[LaunchedNode2]:
        root = ElementTree.fromstring(self.texts[path])
        assert root.tag == "launch"
        assert not root.attrib
        yield from self._body(root, context, path)

    def _body(self, parent: ElementTree.Element, context: LaunchContext, path: str) -> Iterator[LaunchedNode2]:
        for element in parent:
            if element.tag == "keep" and parent.tag == "group":
                continue
            extra = set(element.attrib) - ALLOWED[element.tag] - CONDITIONS
            assert not extra, f"<{element.tag}> with {extra}"
            assert not set(element.attrib) >= CONDITIONS, "if and unless cannot be used together"
            if self._wanted(element, context, path):
                handler = getattr(self, f"_{element.tag}")
                yield from handler(element, context, path) or ()

    def _wanted(self, element: ElementTree.Element, context: LaunchContext, path: str) -> bool:
        for name in CONDITIONS & set(element.attrib):
            assert element.tag not in WITHOUT_CONDITION
            value = self._text(element.attrib[name], context, path).strip().lower()
            assert value in ("true", "1", "false", "0"), value
            if (value in ("true", "1")) is not (name == "if"):
                return False
        return True

    def _arg(self, element: ElementTree.Element, context: LaunchContext, path: str) -> None:
        name = element.attrib["name"]
        if name not in context.variables:
            assert "default" in element.attrib, f"argument {name} was not provided"
            context.variables[name] = self._text(element.attrib["default"], context, path)

    def _let(self, element: ElementTree.Element, context: LaunchContext, path: str) -> None:
        context.variables[element.attrib["name"]] = self._text(element.attrib["value"], context, path)

    def _group(self, element: ElementTree.Element, context: LaunchContext, path: str) -> Iterator[LaunchedNode2]:
        inner = context.copy()
        kept = {
            each.attrib["name"]: self._text(each.attrib["value"], context, path) for each in element.findall("keep")
        }
        if element.attrib.get("forwarding") == "false":
            inner = LaunchContext({})
        inner.variables |= kept
        yield from self._body(element, inner, path)

    def _include(self, element: ElementTree.Element, context: LaunchContext, path: str) -> Iterator[LaunchedNode2]:
        file = str(Path(os.path.normpath(self._text(element.attrib["file"], context, path))))
        for each in element:
            assert each.tag == "arg"
            context.variables[each.attrib["name"]] = self._text(each.attrib["value"], context, path)
        yield from self._file(file, context)

    def _push_ros_namespace(self, element: ElementTree.Element, context: LaunchContext, path: str) -> None:
        pushed = self._text(element.attrib["namespace"], context, path)
        context.variables["ros_namespace"] = join(context.variables.get("ros_namespace", ""), pushed)

    def _set_remap(self, element: ElementTree.Element, context: LaunchContext, path: str) -> None:
        context.remaps.append(self._pair(element, ("from", "to"), context, path))

    def _set_env(self, element: ElementTree.Element, context: LaunchContext, path: str) -> None:
        context.environment.update([self._pair(element, ("name", "value"), context, path)])

    def _set_parameter(self, element: ElementTree.Element, context: LaunchContext, path: str) -> None:
        context.parameters[element.attrib["name"]] = yaml.safe_load(self._text(element.attrib["value"], context, path))

    def _node(self, element: ElementTree.Element, context: LaunchContext, path: str) -> Iterator[LaunchedNode2]:
        texts = {name: self._text(value, context, path) for name, value in element.attrib.items()}
        namespace = join(context.variables.get("ros_namespace", ""), texts.pop("namespace", ""))
        environment, remaps, parameters = dict(context.environment), list(context.remaps), dict(context.parameters)
        for each in element:
            assert not set(each.attrib) - ALLOWED[each.tag], each.attrib
            if each.tag == "env":
                environment.update([self._pair(each, ("name", "value"), context, path)])
            elif each.tag == "remap":
                remaps.append(self._pair(each, ("from", "to"), context, path))
            else:
                merge(parameters, self._param(each, context, path))
        name = f"{namespace.rstrip('/')}/{texts.pop('name')}"
        parts = (texts.pop("pkg"), texts.pop("exec"), shlex.split(texts.pop("args", "")))
        options = {name: value for name, value in texts.items() if name not in CONDITIONS}
        yield LaunchedNode2(name, *parts, options, remaps, environment, parameters)

    def _pair(
        self, element: ElementTree.Element, names: tuple[str, str], context: LaunchContext, path: str
    ) -> tuple[str, str]:
        first, second = (self._text(element.attrib[name], context, path) for name in names)
        return first, second

    def _param(self, element: ElementTree.Element, context: LaunchContext, path: str) -> dict[str, object]:
        if "from" in element.attrib:
            file = os.path.normpath(self._text(element.attrib["from"], context, path))
            text = self.texts[file]
            if element.attrib.get("allow_substs") == "true":
                text = self._text(text, context, path)
            return dict(yaml.safe_load(text)["/**"]["ros__parameters"])
        names = self._text(element.attrib["name"], context, path).split(".")
        value: object = {}
        if len(element):
            for each in element:
                merge(value, self._param(each, context, path))
        else:
            value = read_value(self._text(element.attrib["value"], context, path), element.attrib.get("type"))
        for name in reversed(names):
            value = {name: value}
        assert isinstance(value, dict)
        return value

    def _text(self, text: str, context: LaunchContext, path: str) -> str:
        """A value with all its substitutions, by the grammar of `launch`."""
        return _Substitutions(self, context, path).template(text)

    def perform(self, name: str, words: list[str], context: LaunchContext, path: str) -> str:
        if name == "var":
            return context.variables[words[0]] if words[0] in context.variables else words[1]
        if name == "find-pkg-share":
            return self.packages[words[0]]
        if name == "dirname":
            return str(Path(path).parent)
        if name == "env":
            return os.environ[words[0]] if words[0] in os.environ else words[1]
        if name == "command":
            program, file = shlex.split(words[0])
            assert program == "cat"
            return Path(file).read_text(encoding="utf-8")
        assert name == "eval", name
        names = [each.strip() for each in (words[1] if words[1:] else "math").split(",")]
        modules: dict[str, object] = vars(math).copy() if "math" in names else {}
        return str(eval(words[0], {}, modules | {each: __import__(each) for each in names}))


class _Substitutions:
    """A recursive descent through `$(name word ...)`, whose words are plain or in quotes, and may hold others."""

    def __init__(self, reader: Ros2LaunchReader, context: LaunchContext, path: str) -> None:
        self.reader, self.context, self.path = reader, context, path

    def template(self, text: str) -> str:
        made, place = [], 0
        while place < len(text):
            if text.startswith("$(", place):
                value, place = self.substitution(text, place, " ")
                made.append(value)
            elif text[place] == "\\" and place + 1 < len(text):
                made.append(text[place + 1])
                place += 2
            else:
                made.append(text[place])
                place += 1
        return "".join(made)

    def substitution(self, text: str, place: int, quote: str) -> tuple[str, int]:
        found = re.compile(r"\$\(([A-Za-z][\w-]*)").match(text, place)
        assert found, text[place:]
        place, words = found.end(), []
        while text[place] == " ":
            if text[place + 1] in "'\"" and quote == " ":
                word, place = self.until(text, place + 2, text[place + 1], text[place + 1])
                place += 1
            else:
                word, place = self.until(text, place + 1, " )", quote)
            words.append(word)
        assert text[place] == ")", text[place:]
        return self.reader.perform(found[1], words, self.context, self.path), place + 1

    def until(self, text: str, place: int, ends: str, quote: str) -> tuple[str, int]:
        made = []
        while text[place] not in ends:
            if text.startswith("$(", place):
                value, place = self.substitution(text, place, quote)
                made.append(value)
                continue
            if text[place] == "\\":
                place += 1
            else:
                assert quote != " " or text[place] not in "'\"()", text
            made.append(text[place])
            place += 1
        return "".join(made), place


def read_value(text: str, kind: str | None) -> object:
    if kind == "bool":
        value = yaml.safe_load({"1": "true", "0": "false"}.get(text, text))
        assert isinstance(value, bool), text
        return value
    return TYPES[kind](text) if kind else yaml.safe_load(text or "''")


def merge(into: object, values: Mapping[str, object]) -> None:
    assert isinstance(into, dict)
    for name, value in values.items():
        if isinstance(value, dict) and isinstance(into.get(name), dict):
            merge(into[name], value)
        else:
            into[name] = value


def join(base: str, below: str) -> str:
    """A namespace below another, as `prefix_namespace` of launch_ros joins them."""
    joined = below if below.startswith("/") else f"{base}/{below}"
    return f"/{joined.strip('/')}"
