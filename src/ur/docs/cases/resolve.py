"""A launch file in every case: per base and variant, with default options and with one option changed at a time."""

import itertools
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from ur.check.cases import resolve_cases
from ur.check.rule import LaunchView
from ur.check.worlds import CachedWorld
from ur.docs.cases.started import StartedFile, Starter, find_taking_part
from ur.docs.documents import BaseCase
from ur.docs.words import describe_condition
from ur.launchfile.plan.specs import IncludeSpec, NodeSpec, Plan
from ur.launchfile.syntax import Element, LaunchFile


@dataclass(frozen=True, slots=True)
class FileOutline:
    """The tags `<node>`, `<test>` and `<include>` by position, and every tag's conditions, outermost first."""

    nodes: tuple[Element, ...]
    includes: tuple[Element, ...]
    groups: tuple[Element, ...]  # <launch> and every <group>: parameters may stand in them
    conditions: Mapping[int, tuple[str, ...]]
    raw_conditions: Mapping[int, tuple[str, ...]]  # as they are written
    text: str


def outline_file(tree: LaunchFile) -> FileOutline:
    """Find the tags of a file."""
    nodes: list[Element] = []
    includes: list[Element] = []
    groups: list[Element] = []
    conditions: dict[int, tuple[str, ...]] = {}
    raw: dict[int, tuple[str, ...]] = {}

    def visit(element: Element, above: tuple[str, ...], raw_above: tuple[str, ...]) -> None:
        groups.append(element)
        for child in element.elements:
            own = describe_condition(child)
            whole = (*above, own) if own else above
            raw_whole = raw_above
            if own:
                written = (child.attributes[word] for word in ("if", "unless") if word in child.attributes)
                raw_whole = (*raw_above, *written)
            if whole:
                conditions[child.start] = whole
                raw[child.start] = raw_whole
            if child.name in ("node", "test"):
                nodes.append(child)
            elif child.name == "include":
                includes.append(child)
            elif child.name == "group":
                visit(child, whole, raw_whole)

    if tree.launch is not None:
        visit(tree.launch, (), ())
    return FileOutline(tuple(nodes), tuple(includes), tuple(groups), conditions, raw, tree.source.text)


MAX_CHANGED = 3
MAX_TRIES = 60
_WORD = re.compile(r"[A-Za-z_]\w*")
_LITERAL = re.compile(r"""['"]([^'"]*)['"]""")
_ARGUMENT = re.compile(r"""\barg\(\s*['"](\w+)['"]\s*\)""")
_OPPOSITE = {"true": "false", "false": "true", "1": "0", "0": "1"}
_BASE = frozenset({"robot_base", "robot_variant"})
Assignment = tuple[tuple[str, str], ...]

MAX_DORMANT = 40  # tags below one root that are tried to turn on


@dataclass(frozen=True, slots=True)
class Files:
    """The launch files of a repository by path, and their tags."""

    views: Mapping[str, LaunchView]
    outline_of: Callable[[str], FileOutline]

    def list_dormant(self, path: str, taking_part: set[int]) -> Iterator[Element]:
        """Yield the conditional nodes and includes of a file that are not among those that take part."""
        outline = self.outline_of(path)
        if path not in self.views:
            return
        for element in (*outline.includes, *outline.nodes):
            if element.start in outline.conditions and element.start not in taking_part:
                yield element


@dataclass(frozen=True, slots=True)
class Resolution:
    """One plan of a case. `label`: the option that is changed, `use_rviz:=false`; empty for other guesses."""

    label: str
    plan: Plan

    @property
    def started(self) -> StartedFile:
        """Return the started nodes and includes."""
        assert isinstance(self.plan.started, StartedFile)
        return self.plan.started


@dataclass(frozen=True, slots=True)
class ResolvedCase:
    """A launch file in one case: with its defaults, and with other values. `given` are the arguments of the case."""

    case: BaseCase
    given: Assignment
    default: Resolution
    others: tuple[Resolution, ...]

    @property
    def resolutions(self) -> tuple[Resolution, ...]:
        """Return all resolutions, the default first."""
        return (self.default, *self.others)


def resolve_outcomes(
    view: LaunchView, files: Files, world: CachedWorld, starter: Starter, given: Assignment = ()
) -> tuple[ResolvedCase, ...]:
    """Resolve a launch file in each case, in the order of the bases; `given` arguments are the same in all.

    Tags that no case starts are searched with other values of the arguments that their conditions refer to.
    """
    default: dict[BaseCase, Resolution] = {}
    others: dict[BaseCase, list[Resolution]] = {}
    arguments: dict[BaseCase, tuple[tuple[str, str], ...]] = {}
    for resolved in resolve_cases(view, world, given, load=starter.load):
        values = dict(resolved.case.given)
        case = BaseCase(values.get("robot_base", ""), values.get("robot_variant", ""))
        flipped = resolved.case.flipped
        resolution = Resolution(f"{flipped}:={values[flipped]}" if flipped else "", resolved.plan)
        if case in default:
            others[case].append(resolution)
        else:
            default[case], others[case], arguments[case] = resolution, [], resolved.case.given
    outcomes = tuple(
        ResolvedCase(case, arguments[case], resolution, tuple(others[case])) for case, resolution in default.items()
    )
    extra = list(_find_switches(view, files, outcomes, world, starter))
    if not extra:
        return outcomes
    return tuple(
        replace(outcome, others=(*outcome.others, *_apply_switches(view, outcome, extra, world, starter)))
        for outcome in outcomes
    )


def _find_switches(
    view: LaunchView, files: Files, outcomes: tuple[ResolvedCase, ...], world: CachedWorld, starter: Starter
) -> Iterator[Assignment]:
    there = find_taking_part(resolution.started for outcome in outcomes for resolution in outcome.resolutions)
    dormant = [(path, element) for path in list(there) for element in files.list_dormant(path, there[path])]
    for path, element in dormant[:MAX_DORMANT]:
        if element.start in there[path]:
            continue  # an earlier one has turned it on, too
        assignments = list_assignments(element, files.views[path], files.outline_of(path))
        usable = (each for each in assignments if all(name in view.declared for name, _ in each))
        for assignment, outcome in itertools.product(usable, outcomes):
            now = find_taking_part([_load_with(view, outcome, assignment, world, starter).started])
            if element.start in now.get(path, ()):
                for each, places in now.items():
                    there.setdefault(each, set()).update(places)
                yield assignment
                break


def _apply_switches(
    view: LaunchView, outcome: ResolvedCase, extra: list[Assignment], world: CachedWorld, starter: Starter
) -> Iterator[Resolution]:
    for assignment in extra:
        label = " ".join(f"{name}:={value}" for name, value in assignment)
        yield _load_with(view, outcome, assignment, world, starter, label)


def _load_with(
    view: LaunchView, outcome: ResolvedCase, extra: Assignment, world: CachedWorld, starter: Starter, label: str = ""
) -> Resolution:
    given = tuple(dict((*outcome.given, *extra)).items())
    return Resolution(label, next(resolve_cases(view, world, given, load=starter.load)).plan)


def find_node(resolution: Resolution, start: int) -> NodeSpec | None:
    """Find the node of the file itself whose tag starts at this offset; None if it does not take part."""
    plan = resolution.plan
    for node in plan.nodes:
        if node.origin.span.start == start:
            return node
    return next((test.node for test in plan.tests if test.node.origin.span.start == start), None)


def find_include(resolution: Resolution, start: int) -> IncludeSpec | None:
    """Find the include in the same way."""
    return next((include for include in resolution.plan.includes if include.origin.span.start == start), None)


def list_switches(participates: Iterator[tuple[ResolvedCase, Resolution]]) -> str:
    """Return the options that enable an element which no default enables; empty if a default enables it."""
    labels: dict[str, None] = {}
    for outcome, resolution in participates:
        if resolution is outcome.default:
            return ""
        labels[resolution.label] = None
    return " or ".join(label for label in labels if label)


def list_assignments(element: Element, view: LaunchView, outline: FileOutline) -> Iterator[Assignment]:
    """Yield values that may enable an element, fewest changes first, of the arguments that its conditions refer to."""
    domains = _find_domains(outline.raw_conditions.get(element.start, ()), view)
    tries = 0
    for count in range(1, min(MAX_CHANGED, len(domains)) + 1):
        for names in itertools.combinations(domains, count):
            for values in itertools.product(*(domains[name] for name in names)):
                tries += 1
                if tries > MAX_TRIES:
                    return
                yield tuple(zip(names, values, strict=True))


def _find_domains(conditions: Sequence[str], view: LaunchView) -> Mapping[str, tuple[str, ...]]:
    # By argument the values worth trying: the opposite of a flag, and every text that a condition compares with.
    texts = list(conditions)
    names: dict[str, None] = {}
    position = 0
    while position < len(texts):
        for name in _find_names(texts[position]):
            elements = view.declared.get(name, ())
            if not elements or name in names or (name in _BASE and "robot_base" in view.declared):
                continue
            value = elements[0].attributes.get("value")
            if value is not None:
                texts.append(value)  # follows from other arguments
            else:
                names[name] = None
        position += 1
        if position > 50:
            break
    literals = dict.fromkeys(literal for text in texts for literal in _LITERAL.findall(_ARGUMENT.sub("", text)))
    domains: dict[str, tuple[str, ...]] = {}
    for name in names:
        default = view.declared[name][0].attributes.get("default", "")
        opposite = _OPPOSITE.get(default.strip().lower())
        values = (opposite,) if opposite is not None else (*literals, "true", "false")
        domains[name] = tuple(value for value in values if value and value != default)
    return {name: values for name, values in domains.items() if values}


def _find_names(text: str) -> list[str]:
    """Return the words of a condition that may be arguments: a quoted one is, if it is that of `arg`."""
    return [*_ARGUMENT.findall(text), *_WORD.findall(_LITERAL.sub("", text))]
