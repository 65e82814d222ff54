"""A launch file and all facts on its page, with the bases that it supports."""

from collections.abc import Callable, Iterator, Mapping

from ur.check.cases import resolve_cases
from ur.check.rule import LaunchView
from ur.check.worlds import CachedWorld
from ur.docs.cases.resolve import (
    FileOutline,
    Files,
    ResolvedCase,
    find_include,
    list_switches,
    outline_file,
    resolve_outcomes,
)
from ur.docs.cases.started import Starter
from ur.docs.documents import (
    ArgumentDoc,
    BaseCase,
    BaseDoc,
    IncludeDoc,
    LaunchDoc,
    NodeDoc,
    ParamDoc,
    ParamFileDoc,
    SupportDoc,
    TargetDoc,
    TargetState,
    TreeDoc,
    TreeItem,
    Value,
)
from ur.docs.launch.nodes import NodeDescriber, TreeMaker
from ur.docs.repository.bases import find_lacks, match_paths
from ur.docs.repository.collect import DocumentedRepository, is_elsewhere, is_unknown, relative_path
from ur.docs.repository.comments import find_argument_doc, find_needs, find_overview, find_summary
from ur.docs.words import Words, describe_condition, describe_type, join_words, settle_links, types_from_use
from ur.launchfile.plan.specs import (
    ArgumentStep,
    IncludeSpec,
    NodeSpec,
    ParameterFile,
    Plan,
    TraceStep,
    describe_trigger,
)
from ur.launchfile.syntax import Element
from ur.source.diagnostic import Diagnostic, Severity
from ur.source.file import Span

# About this computer, or about what other tools say better; see ur check.
_NOT_HERE = frozenset({"unknown-package", "unset-variable", "unknown-machine", "duplicate-machine"})


def describe_support(
    outcomes: tuple[ResolvedCase, ...],
    needs: tuple[str, ...],
    bases: Mapping[str, BaseDoc],
    words: Words,
    *,
    has_variant: bool,
) -> tuple[tuple[SupportDoc, ...], tuple[str, ...]]:
    """Return the unmet needs in each case, and the problems in all of them.

    A file without an argument for the variant supports a base if one of its variants meets the needs.
    """
    wrong = {outcome.case: tuple(dict.fromkeys(_list_errors(outcome, words))) for outcome in outcomes}
    everywhere = tuple(text for text in wrong[outcomes[0].case] if all(text in texts for texts in wrong.values()))
    if not outcomes[0].case.base:
        return (), everywhere
    support = []
    for outcome in outcomes:
        lacks = _list_lacks(outcome.case, needs, bases, has_variant)
        errors = (text for text in wrong[outcome.case] if text not in everywhere or len(outcomes) == 1)
        support.append(SupportDoc(outcome.case, (*lacks, *errors)))
    return tuple(support), everywhere


def _list_lacks(
    case: BaseCase, needs: tuple[str, ...], bases: Mapping[str, BaseDoc], has_variant: bool
) -> tuple[str, ...]:
    base = bases.get(case.base)
    if base is None:
        return ()
    by_variant = {"": base.sensors, **dict(base.variants)}
    tried = [by_variant.get(case.variant, base.sensors)] if has_variant else list(by_variant.values())
    lacks = min((find_lacks(needs, features) for features in tried), key=len)
    return tuple(f"needs {' or '.join(need.split('|'))}" for need in lacks)


def _list_errors(outcome: ResolvedCase, words: Words) -> Iterator[str]:
    for found in outcome.default.plan.diagnostics:
        if found.severity is Severity.ERROR and found.rule not in _NOT_HERE and not is_unknown(found.message):
            yield describe_finding(found, words)


def describe_finding(found: Diagnostic, words: Words) -> str:
    """Describe a finding in one line, with its position."""
    message = words.show(found.message)
    if found.span is None:
        return message
    line = found.span.position.line
    return f"{message} ({words.show(found.span.file.path)}, line {line})"


class PlannedFile:
    """A launch file, resolved with its defaults."""

    def __init__(self, view: LaunchView, world: CachedWorld) -> None:
        self.view = view
        self._trace: list[TraceStep] = []
        self.plan: Plan = next(iter(resolve_cases(view, world, trace=self._trace))).plan

    def describe(
        self,
        words: Words,
        find_inside: Callable[[str], str | None],
        included_by: tuple[str, ...],
        started_by: tuple[str, ...],
    ) -> LaunchDoc:
        """Return all documentation of the file. `find_inside`: a path in the repository; None for one outside."""
        view, plan = self.view, self.plan
        path = find_inside(view.path) or view.path
        own = [node for node in plan.nodes if not node.origin.includes]
        includes = tuple(
            _describe_include(each, words, find_inside) for each in plan.includes if not each.origin.includes
        )
        names = [f"`{node.full_name}`" for node in own]
        tree = TreeItem("file", path.rpartition("/")[2], path, children=tuple(self._grow((), words, find_inside)))
        trees = (TreeDoc((), tree),)
        errors = (found for found in plan.diagnostics if found.severity is Severity.ERROR)
        return LaunchDoc(
            path=path,
            package=view.package.name if view.package is not None else "",
            folder=path.rpartition("/")[0].removesuffix("/launch"),
            summary=f"Starts {join_words(names)}." if 0 < len(names) <= 4 else "",
            overview="",
            needs=(),
            arguments=tuple(self._describe_arguments(words)),
            nodes=tuple(_describe_node(node, words) for node in own),
            params=(),
            param_files=(),
            includes=includes,
            included_by=included_by,
            started_by=started_by,
            trees=trees,
            support=(),
            problems=tuple(dict.fromkeys(describe_finding(found, words) for found in errors)),
            launcher=plan.launcher,
        )

    def _describe_arguments(self, words: Words) -> Iterator[ArgumentDoc]:
        steps = [step for step in self._trace if isinstance(step, ArgumentStep) and not step.origin.includes]
        for step in {step.name: step for step in steps}.values():
            default = words.show(step.written if step.value is None else step.value)
            type_ = " or ".join(step.choices) if step.choices else describe_type(step.name, default, {})
            kind = "required" if step.kind == "required" else "optional"
            yield ArgumentDoc(step.name, kind, "" if kind == "required" else default, type_, step.doc, "")  # type: ignore[arg-type]  # one of two

    def _grow(
        self, chain: tuple[Span, ...], words: Words, find_inside: Callable[[str], str | None]
    ) -> Iterator[TreeItem]:
        items: list[NodeSpec | IncludeSpec] = [node for node in self.plan.nodes if node.origin.includes == chain]
        items += [each for each in self.plan.includes if each.origin.includes == chain]
        for item in sorted(items, key=lambda each: each.origin.span.start):
            if isinstance(item, NodeSpec):
                when = describe_trigger(item.trigger) if item.trigger is not None else ""
                detail = words.show(f"{item.package}/{item.type}".lstrip("/"))
                yield TreeItem("node", words.show(item.full_name), "", detail, when)
            elif is_elsewhere(item.file) or is_unknown(item.file):
                yield TreeItem("elsewhere" if is_elsewhere(item.file) else "unknown", words.show(item.file))
            else:
                path = find_inside(item.file) or words.show(item.file)
                inner = tuple(self._grow((*chain, item.origin.span), words, find_inside))
                yield TreeItem("file" if item.found else "missing", path.rpartition("/")[2], path, children=inner)


def _describe_include(each: IncludeSpec, words: Words, find_inside: Callable[[str], str | None]) -> IncludeDoc:
    path = find_inside(each.file)
    name = words.show(each.file)
    state = "elsewhere" if path is None else "found" if each.found else "missing"
    target = TargetDoc(name if path is None else name.rpartition("/")[2], path or "", state)  # type: ignore[arg-type]  # one of three
    passes = tuple((key, words.show(value)) for key, value in each.arguments)
    return IncludeDoc(" ".join(each.origin.span.text.split()), (target,), (), "", passes)


def _describe_node(node: NodeSpec, words: Words) -> NodeDoc:
    def value(text: str) -> tuple[Value, ...]:
        return (Value(words.show(text)),)

    params: list[ParamDoc] = []
    files: list[ParamFileDoc] = []
    for source in node.sources:
        if isinstance(source, ParameterFile):
            files.append(ParamFileDoc(value(source.path), ()))
        else:
            params += [ParamDoc(f"~{name}", value(str(each))) for name, each in source.values]
    traits = [f"component in `{node.container}`"] if node.container else []
    traits += [node.kind] if node.kind in ("lifecycle", "container", "program") else []
    traits += [f"starts {describe_trigger(node.trigger)}"] if node.trigger is not None else []
    traits += ["respawns"] if node.respawn else []
    return NodeDoc(
        names=value(node.full_name),
        package=value(node.package),
        type=value(node.type),
        machine="",
        conditions=(),
        only_with="",
        cases=(),
        traits=tuple([*traits, "its end ends all"] if node.required else traits),
        params=tuple(params),
        param_files=tuple(files),
        remaps=tuple((words.show(source), words.show(target)) for source, target in node.remaps),
        topics=(),
    )


_NAMES = 4


class LaunchDescriber:
    """Describes the launch files of a repository. `bases` are all of its bases, by name."""

    def __init__(self, repository: DocumentedRepository, bases: Mapping[str, BaseDoc]) -> None:
        self.repository = repository
        self.bases = bases
        self.starter = Starter(repository.trees)
        self.outlines: dict[str, FileOutline] = {}
        self.files = Files(repository.views, self.outline_of)
        self.outcomes: dict[str, tuple[ResolvedCase, ...]] = {}
        self.trees = TreeMaker(repository.views, self.outline_of, self.show_path)
        self.packages = {part.package.folder: part.package.name if part.is_package else "" for part in repository.parts}
        self.includers: dict[str, dict[str, None]] = {}
        self.planned = {
            path: PlannedFile(view, repository.world)
            for path, view in repository.views.items()
            if view.tree.for_other_launcher
        }
        for path in repository.views:
            if path in self.planned:
                for spec in self.planned[path].plan.includes:
                    self.includers.setdefault(spec.file, {})[path] = None
                continue
            for outcome in self.resolve(path):
                for resolution in outcome.resolutions:
                    for include in resolution.plan.includes:
                        self.includers.setdefault(include.file, {})[path] = None
            for element in self.list_open_includes(path):
                for target in match_paths(element.attributes.get("file", ""), repository.views[path]):
                    self.includers.setdefault(target, {})[path] = None

    def list_open_includes(self, path: str) -> Iterator[Element]:
        """Yield the includes of a file that take part in no case, or whose file depends on the user's input."""
        known: dict[int, bool] = {}
        for outcome in self.resolve(path):
            for resolution in outcome.resolutions:
                for include in resolution.plan.includes:
                    start = include.origin.span.start
                    known[start] = known.get(start, True) and not is_unknown(include.file)
        yield from (element for element in self.outline_of(path).includes if not known.get(element.start, False))

    def show_path(self, path: str) -> str:
        """Return a path relative to the root of the repository."""
        return relative_path(path, self.repository.root)

    def find_inside(self, path: str) -> str | None:
        """Return a path relative to the root of the repository; None for one outside of it."""
        shown = self.show_path(path)
        return None if is_unknown(path) or shown.startswith("..") else shown

    def outline_of(self, path: str) -> FileOutline:
        """Return the tags of a file."""
        if path not in self.outlines:
            tree = self.repository.trees.get(path)
            self.outlines[path] = outline_file(tree) if tree is not None else FileOutline((), (), (), {}, {}, "")
        return self.outlines[path]

    def resolve(self, path: str) -> tuple[ResolvedCase, ...]:
        """Resolve a file in every case."""
        if path not in self.outcomes:
            view = self.repository.views[path]
            self.outcomes[path] = resolve_outcomes(view, self.files, self.repository.world, self.starter)
        return self.outcomes[path]

    def exists(self, path: str) -> bool:
        """Return whether a file or folder exists at a path relative to the root of the repository."""
        whole = f"{self.repository.root}/{path}"
        return self.repository.world.is_file(whole) or bool(self.repository.world.list_folder(whole))

    def describe_trees(self, view: LaunchView, given: tuple[tuple[str, str], ...] = ()) -> tuple[TreeDoc, ...]:
        """Describe the nodes that a file starts, per base, with some arguments."""
        outcomes = (
            resolve_outcomes(view, self.files, self.repository.world, self.starter, given)
            if given
            else self.resolve(view.path)
        )
        return self.trees.make_trees(view.path, outcomes, Words(view, self.packages))

    def describe(self, view: LaunchView, started_by: tuple[str, ...]) -> LaunchDoc:
        """Return all documentation of a launch file."""
        if view.path in self.planned:
            included_by = tuple(sorted(self.show_path(each) for each in self.includers.get(view.path, ())))
            words = Words(view, self.packages)
            return self.planned[view.path].describe(words, self.find_inside, included_by, started_by)
        outcomes = self.resolve(view.path)
        words = Words(view, self.packages)
        outline = self.outline_of(view.path)
        nodes = NodeDescriber(outcomes, words, view.path, self.find_inside)
        node_docs = tuple(nodes.describe(each, outline.conditions.get(each.start, ())) for each in outline.nodes)
        includes = tuple(
            describe_include(each, outline.conditions.get(each.start, ()), view, outcomes, words, self.show_path)
            for each in outline.includes
        )
        needs = find_needs(view)
        support, problems = describe_support(
            outcomes, needs, self.bases, words, has_variant="robot_variant" in view.declared
        )
        unreadable = tuple(
            describe_finding(found, words)
            for found in view.tree.diagnostics
            if found.span is not None and found.span.file.path == view.path and found.severity is Severity.ERROR
        )
        trees = self.trees.make_trees(view.path, outcomes, words)
        path = self.show_path(view.path)
        folder = path.rpartition("/")[0]
        return LaunchDoc(
            path=path,
            package=view.package.name if view.package is not None else "",
            folder=(folder.removesuffix("/launch") if folder != "launch" else "launch"),
            summary=find_summary(view) or _summarise(node_docs, includes),
            overview=settle_links(find_overview(view), path.rpartition("/")[0], self.exists),
            needs=needs,
            arguments=tuple(_describe_arguments(view)),
            nodes=node_docs,
            params=tuple(param for group in outline.groups for param in nodes.describe_params(group)),
            param_files=tuple(each for group in outline.groups for each in nodes.describe_param_files(group)),
            includes=includes,
            included_by=tuple(sorted(self.show_path(each) for each in self.includers.get(view.path, ()))),
            started_by=started_by,
            trees=trees,
            support=support if not unreadable else (),
            problems=tuple(dict.fromkeys((*unreadable, *problems))),
        )


def _describe_arguments(view: LaunchView) -> Iterator[ArgumentDoc]:
    launch = view.tree.launch
    used = types_from_use(view)
    for name, elements in view.declared.items():
        element = elements[0]
        value, default = element.attributes.get("value"), element.attributes.get("default")
        documented = (find_argument_doc(each, launch) for each in elements if launch and each in launch.children)
        yield ArgumentDoc(
            name=name,
            kind="convenience" if value is not None else "required" if default is None else "optional",
            default=value if value is not None else default or "",
            type=describe_type(name, default if value is None else value, used),
            doc=next((text for text in documented if text), ""),
            condition=describe_condition(element),
        )


def _summarise(nodes: tuple[NodeDoc, ...], includes: tuple[IncludeDoc, ...]) -> str:
    # For a file without documentation of its own.
    names = list(dict.fromkeys(value.text for node in nodes for value in node.names))
    files = list(dict.fromkeys(target.name for include in includes for target in include.targets))
    parts = []
    if names:
        parts.append("Starts " + _list_some([f"`{name}`" for name in names]))
    if files:
        parts.append(("includes " if parts else "Includes ") + _list_some([f"`{name}`" for name in files]))
    return "; ".join(parts) + "." if parts else ""


def _list_some(words: list[str]) -> str:
    if len(words) <= _NAMES:
        return join_words(words)
    return f"{', '.join(words[: _NAMES - 1])} and {len(words) - _NAMES + 1} more"


def describe_include(
    element: Element,
    conditions: tuple[str, ...],
    view: LaunchView,
    outcomes: tuple[ResolvedCase, ...],
    words: Words,
    show_path: Callable[[str], str],
) -> IncludeDoc:
    """Describe an `<include>`. If its file depends on the user's input, every matching file is named."""
    found = [(o, w, spec) for o in outcomes for w in o.resolutions if (spec := find_include(w, element.start))]
    targets: dict[tuple[str, str, str], dict[BaseCase, None]] = {}
    for outcome, _, spec in found:
        if is_elsewhere(spec.file):
            key = (words.show(spec.file, dict(outcome.given)), "", "elsewhere")
        elif is_unknown(spec.file):
            continue
        else:
            path = show_path(spec.file)
            key = (path.rpartition("/")[2], path, "found" if spec.found else "missing")
        targets.setdefault(key, {})[outcome.case] = None
    written = element.attributes.get("file", "")
    every = len(outcomes)
    docs = [
        TargetDoc(name, path, state, () if len(cases) == every else tuple(case for case in cases if case.base))  # type: ignore[arg-type]  # a state, see above
        for (name, path, state), cases in targets.items()
    ]
    if not found or any(is_unknown(spec.file) and not is_elsewhere(spec.file) for _, _, spec in found):
        known = {doc.path for doc in docs}
        paths = (show_path(path) for path in match_paths(written, view))
        fitting = [path for path in paths if path not in known]
        state: TargetState = "found" if not docs and len(fitting) == 1 else "candidate"
        docs += [TargetDoc(path.rpartition("/")[2], path, state) for path in fitting]
    return IncludeDoc(
        written=" ".join(written.split()),
        targets=tuple(docs),
        conditions=conditions,
        only_with=list_switches((outcome, resolution) for outcome, resolution, _ in found),
        passes=tuple(_list_passed(element)),
    )


def _list_passed(element: Element) -> list[tuple[str, str]]:
    passed = [
        (inner.attributes.get("name", ""), " ".join((inner.attributes.get("value") or "").split()))
        for inner in element.elements
        if inner.name == "arg"
    ]
    if element.attributes.get("pass_all_args", "").strip().lower() in ("true", "1"):
        passed.insert(0, ("pass_all_args", ""))
    return passed
