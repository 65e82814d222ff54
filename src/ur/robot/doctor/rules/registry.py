"""Types of the entries of `RULES`: a function that makes findings, and a description of each of its findings."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field

from ur.robot.doctor.findings import ComputerPair, Finding, Where
from ur.robot.doctor.side import Side


@dataclass(frozen=True, slots=True)
class SideRule:
    """A rule about one computer by itself.

    `kinds`: the id of each finding, and its description. `observe`: shell scripts, by name, for facts beyond the fields
    of `Side`; each computer runs them, and their outputs are in `Side.observed`. `simulation`: the rule also applies to
    a simulated robot; other rules are about real robots only. `ros1`: the rule applies to ROS 1 only.
    """

    kinds: Mapping[str, str]
    check: Callable[[Where, Side], Iterable[Finding]]
    simulation: bool = False
    ros1: bool = False
    observe: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class PairRule:
    """A rule about two computers. `kinds`, `ros1` and `observe` are those of SideRule."""

    kinds: Mapping[str, str]
    check: Callable[[ComputerPair], Iterable[Finding]]
    ros1: bool = False
    observe: Mapping[str, str] = field(default_factory=dict)


Rule = SideRule | PairRule
