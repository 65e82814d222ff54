"""A launch file in every case: per base and variant, with its options as they are and changed one at a time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ur.check.cases import resolve_cases
from ur.check.model import LaunchView
from ur.check.worlds import CachedWorld
from ur.docs.model import Case
from ur.docs.started import Started, StartedPlan, Starter
from ur.launchfile.plan.model import IncludeSpec, NodeSpec


@dataclass(frozen=True, slots=True)
class Way:
    """One plan of a case. `label`: the option that is changed, `use_rviz:=false`; empty for other guesses."""

    label: str
    plan: StartedPlan

    @property
    def started(self) -> Started:
        """What is started."""
        assert self.plan.started is not None
        return self.plan.started


@dataclass(frozen=True, slots=True)
class Outcome:
    """A launch file in one case: with its defaults, and in other ways. `given` are the arguments of the case."""

    case: Case
    given: tuple[tuple[str, str], ...]
    plain: Way
    others: tuple[Way, ...]

    @property
    def ways(self) -> tuple[Way, ...]:
        """All of them, the plain one first."""
        return (self.plain, *self.others)


def resolve_outcomes(
    view: LaunchView, world: CachedWorld, starter: Starter, given: tuple[tuple[str, str], ...] = ()
) -> tuple[Outcome, ...]:
    """What a launch file is in each case, in the order of the bases; `given` arguments are the same in all."""
    plain: dict[Case, Way] = {}
    others: dict[Case, list[Way]] = {}
    arguments: dict[Case, tuple[tuple[str, str], ...]] = {}
    for resolved in resolve_cases(view, world, given, load=starter.load):
        plan = resolved.plan
        assert isinstance(plan, StartedPlan)
        values = dict(resolved.case.given)
        case = Case(values.get("robot_base", ""), values.get("robot_variant", ""))
        flipped = resolved.case.flipped
        way = Way(f"{flipped}:={values[flipped]}" if flipped else "", plan)
        if case in plain:
            others[case].append(way)
        else:
            plain[case], others[case], arguments[case] = way, [], resolved.case.given
    return tuple(Outcome(case, arguments[case], way, tuple(others[case])) for case, way in plain.items())


def find_node(way: Way, start: int) -> NodeSpec | None:
    """The node of the file itself whose tag starts here; None when it does not take part."""
    plan = way.plan
    for node in plan.nodes:
        if node.origin.span.start == start:
            return node
    return next((test.node for test in plan.tests if test.node.origin.span.start == start), None)


def find_include(way: Way, start: int) -> IncludeSpec | None:
    """Likewise the include."""
    return next((include for include in way.plan.includes if include.origin.span.start == start), None)


def list_switches(takes_part: Iterator[tuple[Outcome, Way]]) -> str:
    """The options that have to be changed for something that no plain way has; empty where a plain way has it."""
    labels: dict[str, None] = {}
    for outcome, way in takes_part:
        if way is outcome.plain:
            return ""
        labels[way.label] = None
    return " or ".join(label for label in labels if label)
