"""Launch files of ROS 2 in another language: the objects that one describes, as the entities of XML and YAML."""

from collections.abc import Iterable, Mapping
from typing import cast

from ur.launchfile.ros2.entities import TAGS, VALUE_TYPES, Tag
from ur.launchfile.ros2.model import Description, DescriptionProblem, Made, Unknown
from ur.launchfile.ros2.parameters import coerce
from ur.source.file import Span
from ur.tools.convert.state import Findings
from ur.tools.convert.templates import Split, Templates, Unwritable
from ur.tools.convert.yaml_out import XmlTag

_NAMES = {tag.kind: name for name, tag in TAGS.items()} | {"LogInfo": "log"}
_TYPES = {kind: name for name, kind in VALUE_TYPES.items() if kind is not None and name}
_IGNORED = ("condition", "handle_once", "exec_name")
_EVENTS = "XML and YAML have no events: keep this file in Python, or include it"


class TagWriter:
    """Writes the tags of one description; what has no counterpart goes to `findings`."""

    def __init__(self, split: Split, findings: Findings) -> None:
        self._templates, self._findings = Templates(split), findings

    def write_launch(self, description: Description, variables: Mapping[str, str]) -> XmlTag:
        """Return the whole file. `variables` are those that it sets while it is read."""
        root = XmlTag("launch")
        for problem in description.problems:
            self._add(problem.message, problem.span, problem.help or "correct it first")
        for gap in description.gaps:
            self._add(gap.reason, gap.span, "write this part by hand")
        if description.launch is not None:
            span = description.launch.span
            set_first = [Made("SetEnvironmentVariable", {"name": k, "value": v}, span) for k, v in variables.items()]
            root.children = self._actions([*set_first, description.launch])
        return root

    def _add(self, message: str, span: Span | None, help: str) -> None:
        self._findings.add(message, cast("Span", span), help)

    def _actions(self, actions: object) -> list[XmlTag]:
        made: list[XmlTag] = []
        for each in actions if isinstance(actions, (list, tuple)) else [actions]:
            if isinstance(each, (list, tuple)) or (isinstance(each, Made) and each.kind == "LaunchDescription"):
                made += self._actions(each.get("initial_entities") if isinstance(each, Made) else each)
                continue
            self._templates.lets.clear()
            try:
                if isinstance(each, Unknown):
                    raise Unwritable(each.reason, each.span)
                if isinstance(each, Made):
                    tag = self._tag(each)
                    made += [XmlTag("let", {"name": name, "value": text}) for name, text in self._templates.lets]
                    made.append(tag)
            except Unwritable as problem:
                span = problem.span or (each.span if isinstance(each, Made) else None)
                self._add(f"{problem} cannot be converted", span, problem.help)
        return made

    def _tag(self, made: Made) -> XmlTag:
        if made.kind == "EmitEvent" and getattr(made.get("event"), "kind", "") == "ShutdownEvent":
            made = Made("Shutdown", {"reason": cast("Made", made.get("event")).get("reason")}, made.span)
        name = _NAMES.get(made.kind)
        if name is None:
            raise Unwritable(made.kind, made.span, _EVENTS if made.kind == "RegisterEventHandler" else _HELP)
        tag, known = XmlTag(name), TAGS[name]
        targets = {target: (attribute, mode) for attribute, (target, mode) in known.attributes.items() if target}
        lists = {target: inner for inner, target in reversed(tuple(known.lists.items()))}
        for target, value in made.values.items():
            if value is None or target in _IGNORED or (value in ([], (), {}) and target not in targets):
                continue
            span = made.place(target)
            if target in targets:
                attribute, mode = targets[target]
                tag.attributes[attribute] = self._attribute(value, mode, target, span)
            elif target in lists:
                tag.children += self._list(target, lists[target], value, span)
            elif target == known.actions:
                tag.children += self._actions(value)
            else:
                raise Unwritable(f"{target}= of {made.kind}", span)
        tag.attributes |= self._condition(made.get("condition"), made)
        for attribute in sorted(known.required - set(tag.attributes)):
            if attribute not in ("namespace", "name") or made.kind == "ComposableNode":
                raise Unwritable(f"{made.kind} without {attribute}", made.span, f"give it a {attribute}")
            tag.attributes[attribute] = ""
        tag.attributes = {each: tag.attributes[each] for each in _in_order(known, tag.attributes)}
        return tag

    def _condition(self, condition: object, made: Made) -> dict[str, str]:
        if condition is None:
            return {}
        if not isinstance(condition, Made):
            raise Unwritable("this condition", made.place("condition"))
        kind, span = condition.kind, condition.span
        if kind.startswith("LaunchConfiguration"):
            name, value = condition.get("launch_configuration_name"), condition.get("expected_value")
            variable = Made("LaunchConfiguration", {"variable_name": name}, span)
            test = Made("EqualsSubstitution", {"left": variable, "right": value}, span)
            return {"if" if kind.endswith("Equals") and "Not" not in kind else "unless": self._text(test, span)}
        if kind not in ("IfCondition", "UnlessCondition"):
            raise Unwritable(kind, span)
        return {"if" if kind == "IfCondition" else "unless": self._text(condition.get("predicate_expression"), span)}

    def _attribute(self, value: object, mode: str, target: str, span: Span) -> str:
        if mode == "command":
            if isinstance(value, str):
                value = value.split()
            return self._templates.command(value if isinstance(value, (list, tuple)) else [value], span)
        if mode == "exit":
            ends = value if isinstance(value, (list, tuple)) else [value]
            kinds = [each.get("event") if each.kind == "EmitEvent" else each for each in ends if isinstance(each, Made)]
            if len(ends) != 1 or getattr((kinds or [None])[0], "kind", "") not in ("Shutdown", "ShutdownEvent"):
                raise Unwritable("on_exit other than Shutdown()", span, _EVENTS)
            return "shutdown"
        if mode == "yaml":
            return self._typed(value, span)["value"]
        if isinstance(value, bool) and (mode == "flag" or target in ("respawn", "allow_substs")):
            return str(value).lower()
        if target == "launch_description_source" and isinstance(value, Made):
            if not value.kind.endswith("Source"):
                raise Unwritable("an include of a description that the file makes", span)
            value = value.get("location")
        if target == "target_container" and isinstance(value, Made) and value.kind == "ComposableNodeContainer":
            parts = [value.get("namespace") or "", "/", value.get("name")]
            value = parts if parts[0] else parts[2]
        if isinstance(value, Mapping):  # of output=
            streams = {*value.values()}
            if len(streams) != 1:
                raise Unwritable(f"{target}= that differs for each stream", span)
            (value,) = streams
        return self._text(value, span)

    def _text(self, value: object, span: Span) -> str:
        return self._templates.write(value, span)

    def _list(self, target: str, name: str, value: object, span: Span) -> list[XmlTag]:
        items = list(value.items()) if isinstance(value, Mapping) else value
        if isinstance(items, Unknown) or not isinstance(items, Iterable) or isinstance(items, str):
            raise Unwritable(getattr(items, "reason", f"{target}="), span)
        made: list[XmlTag] = []
        for item in items:
            if isinstance(item, Unknown):
                raise Unwritable(item.reason, item.span or span)
            if target == "choices":
                made.append(XmlTag(name, {"value": self._text(item, span)}))
            elif target in ("parameters", "extra_arguments"):
                made += self._parameter(name, item, span)
            elif isinstance(item, Made):
                made.append(self._tag(item))
            else:
                first, second = cast("tuple[object, object]", item)
                words = ("from", "to") if target == "remappings" else ("name", "value")
                made.append(
                    XmlTag(name, dict(zip(words, (self._text(first, span), self._text(second, span)), strict=True)))
                )
        return made

    def _parameter(self, name: str, item: object, span: Span) -> list[XmlTag]:
        if isinstance(item, Mapping):
            return [XmlTag(name, attributes) for attributes in self._values(item, [], span)]
        if isinstance(item, Made) and item.kind == "Parameter":
            value = Made("ParameterValue", {**item.values}, item.span)
            return [XmlTag(name, each) for each in self._values({item.get("name"): value}, [], span)]
        more: dict[str, str] = {}
        if isinstance(item, Made) and item.kind == "ParameterFile":
            if item.get("allow_substs"):
                more["allow_substs"] = self._attribute(item.get("allow_substs"), "flag", "allow_substs", span)
            item = item.get("param_file")
        return [XmlTag(name, {"from": self._text(item, span), **more})]

    def _values(self, values: Mapping[object, object], prefix: list[object], span: Span) -> Iterable[dict[str, str]]:
        for key, value in values.items():
            names = [*prefix, *(["."] if prefix else []), *(key if isinstance(key, tuple) else (key,))]
            if isinstance(value, Mapping):
                yield from self._values(value, names, span)
            else:
                yield {"name": self._text(names, span), **self._typed(value, span)}

    def _typed(self, value: object, span: Span) -> dict[str, str]:
        kind: object = None
        if isinstance(value, Made) and value.kind == "ParameterValue":
            kind, value = value.get("value_type"), value.get("value")
        if isinstance(value, str) and kind is None:
            parts = self._templates.parts(value, span)
            kind = str if any(isinstance(part, Made) for part in parts) or not _is_plain(value, value) else None
        elif isinstance(value, (bool, int, float)):
            kind = None
            text = str(value).lower() if isinstance(value, bool) else repr(value)
            return {"value": text} if _is_plain(text, value) else {"value": text, "type": type(value).__name__}
        elif isinstance(value, (list, tuple)) and not any(isinstance(each, Made) for each in value):
            return self._typed_list(list(value), span)
        elif isinstance(value, (list, tuple)) and not all(isinstance(each, (Made, str)) for each in value):
            texts = [str(each).lower() if isinstance(each, bool) else self._text(each, span) for each in value]
            return {"value": f"[{', '.join(texts)}]"}
        text = self._text(value, span)
        if kind is None:
            return {"value": text}
        if kind not in _TYPES:
            raise Unwritable(f"the type {getattr(kind, '__name__', kind)}", span)
        return {"value": text, "type": _TYPES[kind]}

    def _typed_list(self, values: list[object], span: Span) -> dict[str, str]:
        kinds = {type(each) for each in values}
        if kinds == {int, float}:
            values, kinds = [float(cast("float", each)) for each in values], {float}
        text = "[" + ", ".join(str(each).lower() if isinstance(each, bool) else str(each) for each in values) + "]"
        if _is_plain(text, values) and "$(" not in text and "\\" not in text:
            return {"value": text}
        (kind,) = kinds if len(kinds) == 1 else (str,)
        texts = [self._text(each, span) for each in values]
        separator = next((each for each in (",", ";", "|", "\u241f") if not any(each in text for text in texts)), ",")
        return {"value": separator.join(texts), "type": f"list_of_{kind.__name__}", "value-sep": separator}


_HELP = "write this part by hand, or include the Python file"


def _is_plain(text: str, value: object) -> bool:
    """Return whether a text without a type is read as a value."""
    try:
        read = coerce(text, None, "", cast("Span", None))
    except DescriptionProblem:
        return False
    return read == value and repr(read) == repr(value)


def _in_order(tag: Tag, names: Iterable[str]) -> list[str]:
    order = ["name", "pkg", "exec", *tag.attributes]
    return sorted(names, key=order.index)
