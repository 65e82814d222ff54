"""Graphs of launch files, nodes and topics, as values for all output formats."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Kind = Literal["file", "node", "topic", "service", "action", "missing", "cycle"]


@dataclass(frozen=True, slots=True)
class Branch:
    """A launch file or a node of an include tree. `key` is the file's path or the node's full name."""

    kind: Kind
    key: str
    label: str
    note: str = ""
    children: tuple[Branch, ...] = ()


@dataclass(frozen=True, slots=True)
class GraphBox:
    """A box of a graph; `title` is its long form."""

    id: str
    label: str
    kind: Kind
    title: str = ""


@dataclass(frozen=True, slots=True)
class Arrow:
    """An arrow between two boxes, by id. `sure` is False if it depends on conditions; a `fault` is an error."""

    source: str
    target: str
    label: str = ""
    sure: bool = True
    fault: bool = False


@dataclass(frozen=True, slots=True)
class DrawnGraph:
    """Boxes and arrows, each once, in the order of their first occurrence."""

    boxes: tuple[GraphBox, ...]
    arrows: tuple[Arrow, ...]
