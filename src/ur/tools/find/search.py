"""Search of launch files and programs for everything that has a name."""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fnmatch import translate
from typing import Literal, get_args

from ur.check.cases import resolve_cases
from ur.check.collect import Targets, collect_targets
from ur.check.rule import LaunchView, survey_launch_file
from ur.check.survey import find_uses, walk_elements
from ur.check.worlds import CachedWorld, has_marker
from ur.launchfile.plan.specs import ArgumentStep, NodeSpec, Origin, ParamSpec, RemapStep, TraceStep
from ur.launchfile.world import World
from ur.source.diagnostic import user_error
from ur.source.file import SourceFile, Span
from ur.source.progress import Progress, counted, no_progress

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


_PIECE = re.compile(r"\$\([^)]{0,500}\)")
_FILE_ATTRIBUTES = ("file", "textfile", "binfile")


def find_name(
    name: str, paths: Sequence[str], world: World, kinds: Iterable[Kind] = KINDS, progress: Progress = no_progress
) -> tuple[Occurrence, ...]:
    """Return every definition and use of a name, sorted by kind, name and position, definitions first.

    `paths` are files, folders and packages. Launch files are resolved for every base and variant, so names that depend
    on arguments are found, except for required arguments that are not given. Raises UserError for a bad path.
    """
    cached = CachedWorld(world)
    targets = collect_targets(paths, cached)
    if not (targets.launch_files or targets.yaml_files or targets.programs):
        message = f"no launch file, YAML file or program of a package in {', '.join(paths)}, expected one to search"
        help_ = "launch files end in .launch, .launch.xml, .launch.py or .launch.yaml"
        raise user_error(message, rule="no-launch-files", help=help_)
    wanted = WantedName(name)
    found: dict[tuple[object, ...], Occurrence] = {}
    for each in _everything(targets, cached, frozenset(kinds), wanted, progress):
        if wanted.matches(each.name) and not has_marker(each.name):
            found.setdefault((each.kind, each.name, each.defines, str(each.span)), each)
    return tuple(sorted(found.values(), key=_rank))


def _rank(each: Occurrence) -> tuple[object, ...]:
    return KINDS.index(each.kind), each.name, not each.defines, each.span.file.path, each.span.start


def _everything(
    targets: Targets, world: CachedWorld, kinds: frozenset[Kind], wanted: WantedName, progress: Progress
) -> Iterator[Occurrence]:
    views = [*_views(targets, world, progress)]
    if "file" in kinds:
        paths = (*targets.launch_files, *targets.yaml_files, *targets.programs)
        files = [path for path in paths if wanted.matches(path)]
        yield from (Occurrence("file", path, True, Span(SourceFile(path, ""), 0, 0)) for path in files)
        for view in views:
            yield from _files(view, files)
    for view in counted(views, "searching", "launch files", progress):
        if "arg" in kinds:
            yield from _arguments(view)
        if kinds & {"node", "topic", "param"} or (view.tree.launch is None and "arg" in kinds):
            yield from find_resolved(view, world, kinds)
    if "arg" in kinds:
        for path in targets.programs:
            yield from _in_program(path, world)


def _views(targets: Targets, world: CachedWorld, progress: Progress) -> Iterator[LaunchView]:
    for path in counted(targets.launch_files, "reading", "launch files", progress):
        with suppress(OSError):  # `ur check` reports it
            yield survey_launch_file(path, targets.package_of(path), world)


def _arguments(view: LaunchView) -> Iterator[Occurrence]:
    for element, parent in walk_elements(view.tree.launch):
        for name, span in find_uses(element):
            yield Occurrence("arg", name, False, span)
        if element.name == "arg" and (name := element.attributes.get("name", "")):
            passed = parent is not None and parent.name == "include"
            yield Occurrence("arg", name, not passed, element.value_span("name"), "handed on" if passed else "")


def _in_program(path: str, world: World) -> Iterator[Occurrence]:
    try:
        source = SourceFile(path, world.read_bytes(path).decode("utf-8", "replace"))
    except OSError:
        return
    for match in re.finditer(r"\b([A-Za-z]\w*):=", source.text):
        yield Occurrence("arg", match.group(1), False, Span(source, *match.span(1)), "given")


def _files(view: LaunchView, files: Sequence[str]) -> Iterator[Occurrence]:
    # What is substituted may be anything, so what is written may mean several files.
    for element, _ in walk_elements(view.tree.launch):
        for attribute, value in element.attributes.items():
            written = _PIECE.split(value)
            if not any("/" in part for part in written) and not (attribute in _FILE_ATTRIBUTES and any(written)):
                continue
            pattern = re.compile(".*".join(map(re.escape, written)) + r"\Z")
            for path in files:
                if path != view.path and pattern.search(path):
                    yield Occurrence("file", path, False, element.value_span(attribute), f"<{element.name}>")


def find_resolved(
    view: LaunchView, world: CachedWorld, kinds: frozenset[Kind], *, follow: bool = True
) -> Iterator[Occurrence]:
    """Nodes, topics and parameters of a launch file in every case.

    Without `follow`, only those of the file itself and of the YAML files that it loads.
    """
    for each, origin in _resolved(view, world, kinds):
        if follow or not origin.includes:
            yield each


def _resolved(view: LaunchView, world: CachedWorld, kinds: frozenset[Kind]) -> Iterator[tuple[Occurrence, Origin]]:
    trace: list[TraceStep] = []
    for resolved in resolve_cases(view, world, trace=trace):
        for node in resolved.plan.nodes:
            if "node" in kinds:
                yield Occurrence("node", node.full_name, True, node.origin.span), node.origin
            if "topic" in kinds:
                yield from ((each, node.origin) for each in _waited_for(node))
    for step in trace:
        origin, span = step.origin, step.origin.span
        if isinstance(step, ParamSpec) and "param" in kinds:
            yield Occurrence("param", step.name, True, span), origin
        elif isinstance(step, ArgumentStep) and view.tree.launch is None and "arg" in kinds:
            yield Occurrence("arg", step.name, True, span), origin
        elif isinstance(step, RemapStep) and "topic" in kinds:
            yield Occurrence("topic", step.target, True, span, f"remapped from {step.source}"), origin
            yield Occurrence("topic", step.source, False, span, f"remapped to {step.target}"), origin


def _waited_for(node: NodeSpec) -> Iterator[Occurrence]:
    for condition in node.ready:
        if condition.kind == "topic":
            yield Occurrence("topic", condition.name, False, node.origin.span, "the node waits for it")
