"""Limits on YAML of others: its nesting, before a parser recurses into it, and what its aliases grow to."""

from __future__ import annotations

from typing import Any

import yaml

MAX_DEPTH = 100
MAX_VALUES = 100_000
_SAFE_COUNT = 1000  # so many levels do not exhaust the stack
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def check_depth(text: str) -> None:
    """Raise yaml.YAMLError for a text that is nested deeper than MAX_DEPTH, or is not YAML.

    libyaml composes nodes by recursion in C: a text of 100 kB can exhaust the stack, which no exception reports.
    """
    if sum(map(text.count, "[{-?:")) <= _SAFE_COUNT:
        return  # each level of nesting takes one of these characters
    depth = 0
    for event in yaml.parse(text, Loader=_Loader):
        if isinstance(event, yaml.CollectionStartEvent):
            depth += 1
            if depth > MAX_DEPTH:
                mark: Any = event.start_mark
                raise yaml.composer.ComposerError(None, None, f"nested deeper than {MAX_DEPTH} levels", mark)
        elif isinstance(event, yaml.CollectionEndEvent):
            depth -= 1


def check_size(top: yaml.Node) -> None:
    """Raise yaml.YAMLError for a node that aliases make larger than MAX_VALUES values, or that contains itself."""
    counts: dict[int, int] = {}

    def count(node: yaml.Node) -> int:
        known = counts.get(id(node))
        if known is not None:
            return known
        counts[id(node)] = MAX_VALUES + 1  # as long as it is being counted: then it contains itself
        total = 1
        if isinstance(node, yaml.SequenceNode):
            total += sum(map(count, node.value))
        elif isinstance(node, yaml.MappingNode):
            total += sum(count(key) + count(value) for key, value in node.value)
        counts[id(node)] = total
        return total

    if count(top) > MAX_VALUES:
        message = f"more than {MAX_VALUES:,} values with its aliases"
        raise yaml.composer.ComposerError(None, None, message, top.start_mark)
