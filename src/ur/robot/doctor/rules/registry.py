"""Registry of the rules: a description of the findings of each, and the function that makes them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from ur.robot.doctor.model import Finding, Pair, Where
from ur.robot.doctor.side import Side


@dataclass(frozen=True, slots=True)
class SideRule:
    """Looks at one computer by itself. `kinds`: what each finding's id means."""

    kinds: Mapping[str, str]
    check: Callable[[Where, Side], Iterable[Finding]]


@dataclass(frozen=True, slots=True)
class PairRule:
    """Looks at both computers."""

    kinds: Mapping[str, str]
    check: Callable[[Pair], Iterable[Finding]]


Rule = SideRule | PairRule
