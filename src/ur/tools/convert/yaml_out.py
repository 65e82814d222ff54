"""The text of elements in YAML, whose values have types."""

from collections.abc import Mapping
from contextlib import suppress

import yaml

from ur.launchfile.ros2.entities import TAGS, VALUE_TYPES
from ur.launchfile.ros2.model import DescriptionProblem
from ur.launchfile.ros2.parameters import coerce
from ur.source.file import SourceFile, Span
from ur.tools.convert.xml_out import XmlTag

_WIDTH = 118
_TYPED = ("respawn", "scoped", "forwarding", "allow_substs", "autostart", "shell", "emulate_tty")
_NOWHERE = Span(SourceFile("", ""), 0, 0)


def write_yaml(root: XmlTag) -> str:
    """The text of a whole file. Comments are left out."""
    return yaml.safe_dump({root.name: _children(root.children)}, sort_keys=False, width=_WIDTH, allow_unicode=True)


def _children(tags: list[XmlTag]) -> list[dict[str, object]]:
    return [{tag.name: _entity(tag)} for tag in tags if tag.name]


def _entity(tag: XmlTag) -> object:
    known = TAGS.get(tag.name)
    made: dict[str, object] = {}
    for name, text in tag.attributes.items():
        mode = known.attributes.get(name, ("", ""))[1] if known is not None else ""
        if known is None and name == "value":
            made |= _typed(tag)
        elif known is not None or name not in ("type", "value-sep"):
            made[name] = _read(text, None) if mode in ("flag", "number") or name in _TYPED else text
    inner: list[XmlTag] = []
    for child in tag.children:
        if known is not None and child.name in known.lists:
            made.setdefault(child.name, [])
            made[child.name].append(_entity(child))  # type: ignore[attr-defined]
        else:
            inner.append(child)
    if inner and not made:
        return _children(inner)
    return made | ({"children": _children(inner)} if inner else {})


def _typed(tag: XmlTag) -> Mapping[str, object]:
    """Return the value of a parameter in YAML's own type; with its type where a substitution makes the value."""
    text, name, separator = (tag.attributes.get(each) for each in ("value", "type", "value-sep"))
    text = text or ""
    kind = VALUE_TYPES.get(name)
    if tag.name not in ("param", "extra_arg"):
        return {"value": text}
    if separator:
        item = getattr(kind, "__args__", (kind,))[0]
        return {"value": [_read(part, item) for part in text.split(separator)]}
    if "$(" in text:
        return {"value": text} | ({"type": name} if name else {})
    return {"value": _read(text, kind)}


def _read(text: str, kind: object) -> object:
    with suppress(DescriptionProblem):
        return coerce(text, kind, "", _NOWHERE)
    return text
