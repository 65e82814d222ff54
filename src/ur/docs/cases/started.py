"""Nodes that launch files start, combined from single files: each is resolved once per set of arguments.

The result is that of resolving every tree from its root (a test compares them), in a fraction of the time.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Union

from ur.check.worlds import CachedWorld
from ur.launchfile.plan.names import read_assignments
from ur.launchfile.plan.one_file import HERE, load_one_file
from ur.launchfile.plan.problems import NOT_GIVEN
from ur.launchfile.plan.specs import IncludeSpec, NodeSpec, Plan
from ur.launchfile.syntax import Element, LaunchFile
from ur.source.diagnostic import Diagnostic, Severity, error

MAX_DEPTH = 200
MAX_FILES = 5_000  # that one root file may include, each set of arguments counted


@dataclass(eq=False, slots=True)
class StartedFile:
    """A launch file with its arguments: its own plan, and its nodes and includes with the files they start, in order.

    An include without a result could not be read, or is recursive. Names in `plan` start with `HERE` if they are
    relative to the include.
    """

    path: str
    plan: Plan
    items: tuple[Item, ...] = ()  # tests are nodes among them
    cyclic: set[int] = field(default_factory=set)  # places of the includes that lead back

    @property
    def included(self) -> Iterator[tuple[IncludeSpec, StartedFile | None]]:
        """Yield the includes among the items."""
        return (item for item in self.items if not isinstance(item, NodeSpec))


Item = Union[NodeSpec, tuple[IncludeSpec, StartedFile | None]]  # noqa: UP007 - evaluated, and Started has no `|` yet
_Key = tuple[str, frozenset[tuple[str, str]], bool, int]


class Starter:
    """Resolves launch files of one world, and caches each result."""

    def __init__(self, trees: dict[str, LaunchFile]) -> None:
        self._trees = trees
        self._known: dict[tuple[object, ...], StartedFile] = {}
        self._defaults: dict[str, dict[str, str]] = {}
        self._closed: dict[str, bool] = {}
        self._findings: dict[int, tuple[Diagnostic, ...]] = {}
        self._left = 0

    def load(self, path: str, words: Sequence[str], world: CachedWorld) -> Plan:
        """Return the plan of a root file alone with `NAME:=VALUE` arguments, with the findings of all files below."""
        self._left = MAX_FILES
        started = self._start(path, read_assignments(words)[0], False, world, ())
        assert started is not None  # nothing is above a root
        plan = started.plan
        return Plan(
            nodes=plan.nodes,
            tests=plan.tests,
            params=plan.params,
            clear_params=plan.clear_params,
            machines=plan.machines,
            files=plan.files,
            diagnostics=(*self.findings_of(started), *_find_duplicates(started)),
            commands=plan.commands,
            programs=plan.programs,
            includes=plan.includes,
            started=started,
        )

    def findings_of(self, started: StartedFile) -> tuple[Diagnostic, ...]:
        """Return the findings in a file and in the files that it includes, each once."""
        known = self._findings.get(id(started))
        if known is None:
            self._findings[id(started)] = ()  # for circles
            found = dict.fromkeys(map(_Same, started.plan.diagnostics))
            for include, child in started.included:
                if child is None:
                    found.update(dict.fromkeys(map(_Same, _explain(include, started))))
                else:
                    own = child.plan.diagnostics
                    for each in self.findings_of(child):
                        found[_Same(_as_included(each, include, child) if each in own else each)] = None
            known = self._findings[id(started)] = tuple(same.finding for same in found)
        return known

    def _start(
        self, path: str, arguments: Mapping[str, str], passes_all: bool, world: CachedWorld, above: tuple[_Key, ...]
    ) -> StartedFile | None:
        # None: the file is being read above, with the same arguments.
        if not passes_all:
            defaults = self._literal_defaults(path)
            arguments = {name: value for name, value in arguments.items() if defaults.get(name) != value}
        key = (path, frozenset(arguments.items()), passes_all, 0 if self._is_closed(path) else id(world.environment))
        if key in self._known or key in above:
            return self._known.get(key)
        self._left -= 1
        started = StartedFile(path, load_one_file(path, arguments, world, self._trees, passes_all=passes_all))
        items: list[Item] = [*started.plan.all_nodes()]
        for include in started.plan.includes:
            child: StartedFile | None = None
            if include.found:
                if len(above) < MAX_DEPTH and self._left > 0:
                    child = self._start(include.file, dict(include.arguments), include.passes_all, world, (*above, key))
                if child is None:
                    started.cyclic.add(include.origin.span.start)
            items.append((include, child))
        items.sort(key=place_of)
        started.items = tuple(items)
        self._known[key] = started
        return started

    def _literal_defaults(self, path: str) -> dict[str, str]:
        # Passing a default explicitly changes nothing: one result is used for both.
        known = self._defaults.get(path)
        if known is None:
            known = self._defaults[path] = {}
            tree = self._trees.get(path)
            seen: set[str] = set()
            for element in tree.launch.elements if tree is not None and tree.launch is not None else ():
                name = element.attributes.get("name", "")
                if element.name != "arg":
                    continue
                if name in seen or not _is_plain_default(element):
                    known.pop(name, None)
                else:
                    known[name] = element.attributes["default"]
                seen.add(name)
        return known

    def _is_closed(self, path: str) -> bool:
        # Whether a file means the same wherever it is looked at from: no environment, no relative paths.
        known = self._closed.get(path)
        if known is None:
            tree = self._trees.get(path)
            text = tree.source.text if tree is not None else "env"
            known = self._closed[path] = "env" not in text.replace("<env", "").replace("env-", "") and not (
                tree is not None and _has_relative_path(tree)
            )
        return known


class _Same:
    """A finding, equal to others at the same position."""

    __slots__ = ("_key", "finding")

    def __init__(self, finding: Diagnostic) -> None:
        self.finding = finding
        span = finding.span
        self._key = (finding.rule, finding.message, span.file.path if span else "", span.start if span else 0)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Same) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)


def walk_nodes(started: StartedFile, namespace: str = "/", depth: int = 0) -> Iterator[tuple[str, NodeSpec]]:
    """Yield every started node with its full name, in document order."""
    for item in started.items:
        if isinstance(item, NodeSpec):
            yield place_name(item.full_name, namespace), item
        elif item[1] is not None and depth < MAX_DEPTH:
            yield from walk_nodes(item[1], place_name(item[0].namespace, namespace), depth + 1)


def find_taking_part(roots: Iterable[StartedFile]) -> dict[str, set[int]]:
    """Return by path of a file the offsets of its nodes and includes that take part below any of the roots."""
    found: dict[str, set[int]] = {}
    seen: set[int] = set()
    stack = list(roots)
    while stack:
        started = stack.pop()
        if id(started) not in seen:
            seen.add(id(started))
            found.setdefault(started.path, set()).update(map(place_of, started.items))
            stack.extend(child for _, child in started.included if child is not None)
    return found


def place_of(item: Item) -> int:
    """Return the offset of the tag of a node or include."""
    return (item if isinstance(item, NodeSpec) else item[0]).origin.span.start


def place_name(name: str, namespace: str) -> str:
    """Return a name of a single file in the namespace in which the file is included."""
    return namespace.rstrip("/") + "/" + name.removeprefix(HERE) if name.startswith(HERE) else name


def _find_duplicates(started: StartedFile) -> Iterator[Diagnostic]:
    # The name of a test may be the name of a node: roslaunch never runs both.
    seen: dict[str, NodeSpec] = {}
    for (name, node), _ in zip(walk_nodes(started), range(MAX_FILES), strict=False):
        is_test = node.origin.span.text == "<test"
        first = node if is_test or not node.name else seen.setdefault(name, node)
        if first is not node:
            yield error(f"a second node is named {name}", node.origin.span, rule="duplicate-node")


def _explain(include: IncludeSpec, started: StartedFile) -> Iterator[Diagnostic]:
    span = include.origin.span
    if span.start in started.cyclic:
        yield error(f"{include.file} includes itself", span, rule="include-cycle")
    else:
        yield error(f"{include.file}: no such file", span, rule="missing-file")


def _as_included(found: Diagnostic, include: IncludeSpec, child: StartedFile) -> Diagnostic:
    # From the root an argument may be given; here an including file should have passed it.
    if found.rule == "missing-argument" and found.kind == NOT_GIVEN:
        message = f"argument '{found.subject}' of {child.path} is required and was not passed"
        return Diagnostic(found.severity, message, found.rule, include.origin.span, subject=found.subject)
    if found.rule == "unknown-argument" and found.span is None:
        return Diagnostic(Severity.ERROR, found.message, found.rule, include.origin.span)
    return found


def _is_plain_default(element: Element) -> bool:
    attributes = element.attributes
    return "$" not in attributes.get("default", "$") and not {"if", "unless", "value"} & attributes.keys()


def _has_relative_path(tree: LaunchFile) -> bool:
    stack = list(tree.launch.elements) if tree.launch is not None else []
    while stack:
        element = stack.pop()
        for name in ("file", "textfile", "binfile"):
            path = element.attributes.get(name)
            if path and not path.startswith(("/", "$")):
                return True
        stack.extend(element.elements)
    return False
