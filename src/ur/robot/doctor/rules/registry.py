"""Types of the entries of `RULES`: a function that makes findings, and a description of each of its findings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from ur.robot.doctor.findings import ComputerPair, Finding, Where
from ur.robot.doctor.side import Side


@dataclass(frozen=True, slots=True)
class SideRule:
    """A rule about one computer by itself. `kinds`: the id of each finding, and its description.

    `observe`: what it needs to know beyond the fields of `Side`, as shell scripts by name; each computer runs them, and
    what they print is in `Side.observed`. `simulation`: it matters for a simulated robot, too; the others are about
    what a real robot needs. `ros1`: it matters for ROS 1 only.
    """

    kinds: Mapping[str, str]
    check: Callable[[Where, Side], Iterable[Finding]]
    simulation: bool = False
    ros1: bool = False
    observe: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class PairRule:
    """A rule about two computers. `kinds`, `ros1` and `observe` as in SideRule."""

    kinds: Mapping[str, str]
    check: Callable[[ComputerPair], Iterable[Finding]]
    ros1: bool = False
    observe: Mapping[str, str] = field(default_factory=dict)


Rule = SideRule | PairRule
