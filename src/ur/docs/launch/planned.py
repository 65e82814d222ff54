"""The documents of a launch file of another launcher than roslaunch: from its plan, as it has no tree of tags."""

from collections.abc import Callable, Iterator, Sequence

from ur.check.cases import resolve_cases
from ur.check.rule import LaunchView
from ur.check.worlds import CachedWorld
from ur.docs.documents import (
    ArgumentDoc,
    IncludeDoc,
    LaunchDoc,
    NodeDoc,
    ParamDoc,
    ParamFileDoc,
    TargetDoc,
    TreeDoc,
    TreeItem,
    Value,
)
from ur.docs.launch.graph import draw_graph
from ur.docs.launch.support import describe_finding
from ur.docs.repository.world import is_elsewhere, is_unknown
from ur.docs.words import Words, describe_type, join_words
from ur.graph.boxes import DrawnGraph
from ur.launchfile.plan.specs import (
    ArgumentStep,
    IncludeSpec,
    NodeSpec,
    ParameterFile,
    Plan,
    TraceStep,
    describe_trigger,
)
from ur.source.diagnostic import Severity
from ur.source.file import Span


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
            graph=draw_graph(path, trees) if own or includes else DrawnGraph((), ()),
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
    return NodeDoc(
        names=value(node.full_name),
        package=value(node.package),
        type=value(node.type),
        machine="",
        conditions=(),
        only_with="",
        cases=(),
        traits=tuple(_list_traits(node)),
        params=tuple(params),
        param_files=tuple(files),
        remaps=tuple((words.show(source), words.show(target)) for source, target in node.remaps),
        topics=(),
    )


def _list_traits(node: NodeSpec) -> Sequence[str]:
    traits = [f"component in `{node.container}`"] if node.container else []
    traits += [node.kind] if node.kind in ("lifecycle", "container", "program") else []
    traits += [f"starts {describe_trigger(node.trigger)}"] if node.trigger is not None else []
    traits += ["respawns"] if node.respawn else []
    return [*traits, "its end ends all"] if node.required else traits
