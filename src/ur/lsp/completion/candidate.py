"""A text that an editor offers to insert."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

CandidateKind = Literal["tag", "attribute", "package", "program", "file", "folder", "argument", "value", "rule"]


@dataclass(frozen=True, slots=True)
class Candidate:
    """Something to insert between two offsets. `more`: another candidate may follow at once."""

    label: str
    kind: CandidateKind
    insert: str
    start: int
    end: int
    help: str = ""
    document: str = ""
    more: bool = False
