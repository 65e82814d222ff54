"""YAML files as trees with places, for rules that look at YAML."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import yaml

from ur.source.file import SourceFile, Span
from ur.source.foreign.yaml_text import check_depth

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def compose_documents(source: SourceFile) -> list[yaml.Node]:
    """The documents of a text. Raises yaml.YAMLError."""
    check_depth(source.text)
    return [node for node in yaml.compose_all(source.text, Loader=_Loader) if node is not None]


def is_plain_yaml(source: SourceFile) -> bool:
    """Return whether a text is meant to be YAML as it stands: not a template, not OpenCV's own format."""
    return not source.text.startswith("%YAML:") and "{{" not in source.text and "{%" not in source.text


def span_at(source: SourceFile, mark: Any, end: Any = None) -> Span:
    """The place of a mark of PyYAML; up to the mark `end` where that is in the same line."""
    start = _offset(source, mark)
    if end is not None and end.line == mark.line:
        return Span(source, start, _offset(source, end))
    return Span(source, start, min(start + 1, len(source.text)))


def mappings_in(top: yaml.Node) -> Iterator[yaml.MappingNode]:
    """Every mapping in a tree, each once."""
    stack, seen = [top], {id(top)}
    while stack:
        node = stack.pop()
        inner: list[yaml.Node] = []
        if isinstance(node, yaml.MappingNode):
            yield node
            inner = [part for pair in node.value for part in pair]
        elif isinstance(node, yaml.SequenceNode):
            inner = list(node.value)
        for part in inner:
            if id(part) not in seen:
                seen.add(id(part))
                stack.append(part)


def _offset(source: SourceFile, mark: Any) -> int:
    # libyaml counts bytes in `index` but characters in `column`; lines are safe in both.
    offset = 0
    for _ in range(mark.line):
        offset = source.text.find("\n", offset) + 1
    return int(min(offset + mark.column, len(source.text)))
