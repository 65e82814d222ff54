"""What is drawn."""

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
class Box:
    """A box of a graph; `title` is its long form."""

    id: str
    label: str
    kind: Kind
    title: str = ""


@dataclass(frozen=True, slots=True)
class Arrow:
    """An arrow between two boxes, by id. `sure` is False where nobody knows whether it is so; a `fault` must not be."""

    source: str
    target: str
    label: str = ""
    sure: bool = True
    fault: bool = False


@dataclass(frozen=True, slots=True)
class Graph:
    """Boxes and arrows, each once, in the order in which they were met."""

    boxes: tuple[Box, ...]
    arrows: tuple[Arrow, ...]
