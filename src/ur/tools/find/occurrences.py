"""Definitions and uses of names."""

import re
from dataclasses import dataclass
from fnmatch import translate
from typing import Literal, get_args

from ur.source.file import Span

Kind = Literal["arg", "node", "topic", "param", "file"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A position that defines or uses something. `name` is the full name; `note` explains an unobvious use."""

    kind: Kind
    name: str
    defines: bool
    span: Span
    note: str = ""


class WantedName:
    """A name to search: `scan` matches `/scan` and `/robot/scan`; `*` and `?` match any characters."""

    def __init__(self, name: str) -> None:
        self.name = name
        absolute = name.startswith("/")
        pattern = translate(name if absolute else f"*/{name}")
        self._pattern = re.compile(pattern)

    def matches(self, name: str) -> bool:
        """Return whether a full name (or a path, or an argument) matches."""
        return self._pattern.match(name if name.startswith("/") else f"/{name}") is not None
