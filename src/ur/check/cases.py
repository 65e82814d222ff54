"""Resolution of a launch file for its possible uses: every base and variant, with and without its options.

The normal resolver is used. Required arguments get a unique marker; a finding that contains a marker depends on an
unknown value and is dropped. The expected values of dropped findings ("true or false", "a number") are tried next, so
that both branches of a condition are resolved.
"""

import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from functools import partial
from typing import NamedTuple

from ur.check.rule import LaunchView
from ur.check.survey import walk_elements
from ur.check.worlds import ANONYMOUS, CachedWorld, Environment, Unknowns, has_marker
from ur.launchfile.load import load_plan
from ur.launchfile.plan.problems import NOT_GIVEN, NOT_PYTHON, SPECIAL
from ur.launchfile.plan.specs import Plan, TraceStep
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.syntax import Element, LaunchFile
from ur.source.diagnostic import Diagnostic, Severity

_ROUNDS = 5
_CONDITION = re.compile(r"\s*\$\(arg (\w+)\)\s*\Z")
_BOOLEANS = {"true": "false", "1": "false", "false": "true", "0": "true"}
_OPPOSITES = {"true": "false", "1": "0"}
_ABOUT_VALUES = frozenset({"bad-boolean", "bad-number", "bad-param-value", "bad-choice"})
_ABOUT_EVERY_FILE = frozenset({"unknown-machine"})  # not sure unless every included file is known
# Options exclude one another: not sure where one is changed alone.
_ABOUT_TWO_TAGS = frozenset(
    {
        *("duplicate-arg", "duplicate-node", "duplicate-machine", "param-conflict"),
        *("undeclared-argument", "unknown-machine"),
    }
)


class StartCase(NamedTuple):
    """One way to start a file: given arguments by name. `flipped`: an option with the opposite of its default."""

    given: tuple[tuple[str, str], ...] = ()
    flipped: str | None = None

    @property
    def label(self) -> str:
        """Return the case as typed: `robot_base:=magni`."""
        return " ".join(f"{name}:={value}" for name, value in self.given)


class Resolved(NamedTuple):
    """A plan and its case; its diagnostics contain only certain findings.

    `by_defaults`: the default of an environment variable that is not set here was used.
    """

    case: StartCase
    plan: Plan
    by_defaults: bool = False


Loader = Callable[[str, Sequence[str], CachedWorld], Plan]


def list_cases(view: LaunchView, given: tuple[tuple[str, str], ...] = ()) -> list[StartCase]:
    """Return the cases of a launch file: each base and variant, with defaults and with each option flipped.

    The `given` arguments are the same in all.
    """
    names = {name for name, _ in given}
    bases = [] if "robot_base" in names else _base_cases(view, names)
    plain = [StartCase((*given, *each)) for each in bases or [()]]
    flips = [flip for flip in _flips(view) if flip[0] not in names]
    return plain + [StartCase((*case.given, flip), flipped=flip[0]) for flip in flips for case in plain]


def resolve_cases(
    view: LaunchView,
    world: CachedWorld,
    given: tuple[tuple[str, str], ...] = (),
    trace: list[TraceStep] | None = None,
    load: Loader | None = None,
    passed: frozenset[str] | None = None,
    trees: dict[str, LaunchFile] | None = None,
) -> Iterator[Resolved]:
    """Yield the plans of a launch file, one or two per case, made by `load`.

    See load_plan for `trace` and `trees`. With `passed`, names of arguments, the defaults of those and of unset
    environment variables are ignored: they are unknown, as when another file includes this one.
    """
    trees = {} if trees is None else trees
    load = load or partial(_load, trace=trace, trees=trees, budget=Budget())
    unknown = list_unknown(view, passed or ())
    for case in list_cases(view, given):
        yield from _resolve(view.path, case, unknown, world, load, no_defaults=passed is not None)


def list_unknown(view: LaunchView, passed: Collection[str] = ()) -> list[str]:
    """Return the arguments of a launch file with unknown values: those without a default, and `passed` ones."""
    return [name for name, elements in view.declared.items() if all(_is_unknown(each, passed) for each in elements)]


def _load(
    path: str,
    words: Sequence[str],
    world: CachedWorld,
    trace: list[TraceStep] | None,
    trees: dict[str, LaunchFile],
    budget: Budget,
) -> Plan:
    return load_plan([path], words, world, trace, trees, budget=budget)


def _base_cases(view: LaunchView, given: set[str]) -> list[tuple[tuple[str, str], ...]]:
    if view.package is None or "robot_base" not in view.declared:
        return []
    with_variants = "robot_variant" in view.declared and "robot_variant" not in given
    cases: list[tuple[tuple[str, str], ...]] = []
    for base in view.package.bases:
        cases.append((("robot_base", base.name),))
        variants = base.variants if with_variants else ()
        cases.extend((("robot_base", base.name), ("robot_variant", variant)) for variant in variants)
    return cases


def _flips(view: LaunchView) -> list[tuple[str, str]]:
    conditions = {
        match.group(1)
        for element, _ in walk_elements(view.tree.launch)
        for match in (_CONDITION.match(element.attributes.get(name, "")) for name in ("if", "unless"))
        if match
    }
    flips = []
    for name in sorted(conditions & set(view.declared)):
        default = view.declared[name][0].attributes.get("default", "").strip().lower()
        if default in _BOOLEANS:
            flips.append((name, _BOOLEANS[default]))
    return flips


def _is_unknown(element: Element, passed: Collection[str]) -> bool:
    if "value" in element.attributes:
        return False
    return "default" not in element.attributes or element.attributes.get("name") in passed


def _resolve(
    path: str, case: StartCase, unknown: list[str], world: CachedWorld, load_file: Loader, *, no_defaults: bool
) -> Iterator[Resolved]:
    unknowns = Unknowns()
    note = partial(world.note, "environment")
    environment = Environment(world.environment, unknowns, no_defaults=no_defaults, note=note)
    open_world = world.seen_from(path.rpartition("/")[0], environment)
    given = dict(case.given)

    def load() -> Plan:
        words = [f"{name}:={value}" for name, value in given.items()]
        words += [f"{name}:={unknowns.value_of(name)}" for name in unknown if name not in given]
        return load_file(path, words, open_world)

    plan = load()
    for _ in range(_ROUNDS):
        learnt = _learn(plan.diagnostics, unknowns)
        if not learnt:
            break
        unknowns.tried.update(learnt)
        plan = load()
    first = _only_sure(plan, case, unknowns, open_world)
    if not set(unknowns.tried.values()) & set(_OPPOSITES):
        yield Resolved(case, first, unknowns.defaults_used)
        return
    unknowns.tried = {name: _OPPOSITES.get(value, value) for name, value in unknowns.tried.items()}
    second = _only_sure(load(), case, unknowns, open_world)
    # Options that are all on, or all off, may exclude one another: what speaks of two tags has to be in both plans.
    yield Resolved(case, _without_pairs(first, second), unknowns.defaults_used)
    yield Resolved(case, _without_pairs(second, first), unknowns.defaults_used)


def _without_pairs(plan: Plan, other: Plan) -> Plan:
    places = {(found.rule, str(found.span)) for found in other.diagnostics}
    kept = (
        found
        for found in plan.diagnostics
        if found.rule not in _ABOUT_TWO_TAGS or (found.rule, str(found.span)) in places
    )
    return plan._replace(diagnostics=tuple(kept))


def _learn(findings: Iterable[Diagnostic], unknowns: Unknowns) -> dict[str, str]:
    # A value to try for each unknown that findings speak of. 1 is a number and a condition, but no flag.
    learnt: dict[str, str] = {}
    for found in findings:
        for name in unknowns.names_in(found.message):
            value: str | None = None
            if found.rule == "bad-boolean":
                value = "1" if "1" in found.expected else "true"
            elif found.rule in ("bad-number", "bad-param-value"):
                value = "1"
            elif found.rule == "bad-choice" and found.expected:
                value = found.expected[0]
            if value is not None and learnt.get(name, "1") == "1":
                learnt[name] = value
    return learnt


def _only_sure(plan: Plan, case: StartCase, unknowns: Unknowns, world: CachedWorld) -> Plan:
    whole = not any(map(_hides_a_file, plan.diagnostics)) and all(include.found for include in plan.includes)
    sure = (
        found
        for found in plan.diagnostics
        if _is_sure(found, case, unknowns, world) and (whole or found.rule not in _ABOUT_EVERY_FILE)
    )
    return plan._replace(diagnostics=tuple(sure))


def _hides_a_file(found: Diagnostic) -> bool:
    # An <include> whose file is not known, or an <arg> that may be part of its path.
    if found.span is None or found.severity is not Severity.ERROR:
        return False
    tag = found.span.file.text.rfind("<", 0, found.span.start + 1)
    return tag >= 0 and found.span.file.text.startswith(("<include", "<arg"), tag)


def _is_path_of_user(found: Diagnostic, world: CachedWorld) -> bool:
    # A default like "" or "none", which the user of the file replaces, or a path of another computer.
    if found.rule != "missing-file" or found.span is None or found.kind == SPECIAL:
        return False
    if "/" not in found.subject:
        return "$" in found.span.text
    if not found.subject.startswith("/") or "$(find " in found.span.text or "$(dirname)" in found.span.text:
        return False
    folder = found.subject
    while folder := folder.rpartition("/")[0]:
        if world.is_file(f"{folder}/package.xml"):
            return False
    return True


def _is_sure(found: Diagnostic, case: StartCase, unknowns: Unknowns, world: CachedWorld) -> bool:
    texts = (found.message, found.help or "", *(note.message for note in found.notes))
    if any(map(has_marker, texts)):
        return False
    if found.span is not None and found.span.file.path == "<command line>":
        return False
    if found.kind == NOT_GIVEN:
        return False  # an argument of the file itself, set when it is started
    if found.rule == "bad-eval" and found.kind != NOT_PYTHON:
        return not (unknowns.any_used or case.flipped)  # the result may depend on something unknown
    if found.rule in _ABOUT_VALUES and unknowns.tried and found.span is not None and "$" in found.span.text:
        return False  # the value was guessed
    if found.rule == "empty-namespace" and "$" in found.subject:
        return False  # as with paths: the user of the file gives it
    if found.rule == "duplicate-node" and ANONYMOUS in found.subject:
        return False  # $(anon ...) is another name in each file
    return not _is_path_of_user(found, world) and not (case.flipped and found.rule in _ABOUT_TWO_TAGS)
