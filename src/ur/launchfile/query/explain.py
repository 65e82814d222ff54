"""`ur explain`: the origin of a parameter, argument, remap or node's value, layer by layer."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection, Iterator, Sequence
from typing import NamedTuple

from ur.launchfile.load import load_plan
from ur.launchfile.plan.names import canonical_name, join_names, read_assignments
from ur.launchfile.plan.specs import ArgumentStep, NodeSpec, Origin, ParamSpec, Plan, RemapStep, TraceStep, ValueStep
from ur.launchfile.syntax import (
    Element,
    LaunchFile,
    SubstitutionProblem,
    is_eval,
    parse_launch_file,
    parse_substitutions,
)
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import Severity, UserError, user_error
from ur.source.file import Span
from ur.source.printable import printable
from ur.source.suggest import suggest


def list_nodes(plan: Plan) -> list[str]:
    """Answer `--nodes`: full names of nodes and tests, in document order, nodes first; nameless ones are left out."""
    return [node.full_name for node in plan.all_nodes() if node.name]


def list_files(plan: Plan) -> list[str]:
    """Answer `--files`: every launch file read, sorted; roslaunch prints them in no order."""
    return sorted(plan.files)


def find_node_file(plan: Plan, name: str) -> str:
    """Answer `--find-node NAME`: the launch file that defines a node. Raises UserError if there is none."""
    full_name = join_names("/", name)
    for node in plan.all_nodes():
        if node.name and node.full_name == full_name:
            return node.origin.span.file.path
    names = list_nodes(plan)
    raise user_error(
        f"unknown node '{full_name}', expected one of {', '.join(names) or 'none'}",
        rule="unknown-node",
        help=suggest(full_name, names),
        subject=full_name,
    )


def dump_params(plan: Plan) -> str:
    """Answer `--dump-params`: every parameter as YAML, as roslaunch prints it. Commands have to be run before."""
    import yaml

    return str(yaml.safe_dump({param.name: param.value for param in plan.params})) + "\n"


_WORD = re.compile(r"[A-Za-z_]\w*")
_LONG = 70


class ExplanationStep(NamedTuple):
    """One step of the resolution of a value, its position, and the steps that it depends on."""

    text: str
    span: Span | None = None
    below: tuple[ExplanationStep, ...] = ()


def explain_name(
    name: str,
    files: Sequence[str],
    arguments: Sequence[str],
    world: World,
    parsed: dict[str, LaunchFile] | None = None,
    describe: Callable[[NodeSpec, Plan], str] = lambda _node, _plan: "",
) -> tuple[ExplanationStep, ...]:
    """Return everything with this name in launch files: parameters, arguments, remaps and nodes, with their layers.

    A name without its namespace is enough: `rate` finds `/talker/rate`. `parsed` is that of `load_plan`.
    `describe` returns what else is to be known about a node, or ''. Raises UserError when nothing has this name.
    """
    trace: list[TraceStep] = []
    plan = load_plan(files, arguments, world, trace, parsed=parsed)
    layers = tuple(_Explainer(plan, trace, read_assignments(arguments)[0], world, describe).explain(name))
    if layers:
        return layers
    errors = [found for found in plan.diagnostics if found.severity is Severity.ERROR]
    if errors:
        raise UserError(*errors)
    names = {word for step in trace for word in _names_of(step)} | {node.full_name for node in plan.nodes}
    raise user_error(
        f"{name} is no parameter, argument, remap or node of {', '.join(files)}",
        rule="unknown-name",
        help=suggest(name, names | {each.rpartition("/")[2] for each in names})
        or "`ur launch --dump json FILE` shows all names",
        subject=name,
    )


def list_names(
    files: Sequence[str], arguments: Sequence[str], world: World, parsed: dict[str, LaunchFile] | None = None
) -> dict[str, str]:
    """Return the names that `explain_name` accepts, with their kinds; nodes and parameters also without namespace."""
    trace: list[TraceStep] = []
    plan = load_plan(files, arguments, world, trace, parsed=parsed)
    names = {step.name: "argument" for step in trace if isinstance(step, ArgumentStep) and step.passed_to is None}
    names.update({step.source: "remap" for step in trace if isinstance(step, RemapStep)})
    full = {node.full_name: "node" for node in plan.nodes}
    full.update({step.name: "parameter" for step in trace if isinstance(step, ParamSpec)})
    for name, kind in full.items():
        names.setdefault(name.rpartition("/")[2], kind if name.count("/") == 1 else f"{kind} {name}")
    return {**dict(sorted(names.items())), **dict(sorted(full.items()))}


def format_layers(layers: Sequence[ExplanationStep], depth: int = 0) -> str:
    """Format layers as indented lines, each with its position."""
    lines = []
    for layer in layers:
        place = f"{layer.span}: " if layer.span else ""
        lines.append(f"{'  ' * depth}{printable(place + layer.text)}\n{format_layers(layer.below, depth + 1)}")
    return "".join(lines)


def _names_of(step: TraceStep) -> tuple[str, ...]:
    if isinstance(step, ValueStep):
        return ()
    return (step.source,) if isinstance(step, RemapStep) else (step.name,)


class _Explainer:
    def __init__(
        self,
        plan: Plan,
        trace: list[TraceStep],
        given: Collection[str],
        world: World,
        describe: Callable[[NodeSpec, Plan], str],
    ) -> None:
        self.plan, self.describe = plan, describe
        self.given = given
        self.world = world
        arguments = [step for step in trace if isinstance(step, ArgumentStep)]
        self.declared = [step for step in arguments if step.passed_to is None]
        self.passed = [step for step in arguments if step.passed_to is not None]
        self.remaps = [step for step in trace if isinstance(step, RemapStep)]
        self.params = [step for step in trace if isinstance(step, ParamSpec)]
        self.trees: dict[str, Element | None] = {}

    def explain(self, name: str) -> Iterator[ExplanationStep]:
        wanted = canonical_name(name)
        for node in self.plan.all_nodes():
            if _means(wanted, node.full_name):
                yield self.explain_node(node)
        for full_name in dict.fromkeys(param.name for param in self.params):
            if _means(wanted, full_name):
                *earlier, last = [param for param in self.params if param.name == full_name]
                value = f"what `{last.command}` prints" if last.command is not None else _short(repr(last.value))
                below = [self.tag_layer(last.origin), *self.includes(last.origin)]
                below += [
                    ExplanationStep(f"set to {_short(repr(step.value))} before, and replaced", step.origin.span)
                    for step in reversed(earlier)
                ]
                yield ExplanationStep(f"parameter {last.name} = {value}", None, tuple(below))
        for argument in self.declared:
            if argument.name == name:
                yield self.explain_argument(argument)
        for remap in self.remaps:
            if wanted in (remap.source, canonical_name(remap.source)):
                yield self.explain_remap(remap)

    def explain_node(self, node: NodeSpec) -> ExplanationStep:
        text = f"node {node.full_name} runs {node.type} of package {node.package}"
        more = self.describe(node, self.plan)
        below = (*((ExplanationStep(more),) if more else ()), self.tag_layer(node.origin), *self.includes(node.origin))
        return ExplanationStep(text, None, below)

    def explain_remap(self, step: RemapStep) -> ExplanationStep:
        pair = (step.source, step.target)
        nodes = ", ".join(node.full_name for node in self.plan.nodes if pair in node.remaps) or "no node"
        below = (self.tag_layer(step.origin), *self.includes(step.origin), ExplanationStep(f"in force for {nodes}"))
        return ExplanationStep(f"remap {step.source} to {step.target}", None, below)

    def explain_argument(self, step: ArgumentStep) -> ExplanationStep:
        value = "(no value)" if step.value is None else _short(repr(step.value))
        text = f"argument {step.name} = {value}"
        if step.kind == "value":
            return ExplanationStep(text, step.origin.span, (self.written("value", step),))
        below: list[ExplanationStep] = []
        if step.handed_over:
            below.append(self.passed_layer(step))
        elif not step.origin.includes and step.name in self.given:
            below.append(ExplanationStep(f"given: {step.name}:={step.value}"))
        elif step.kind == "default":
            return ExplanationStep(text, step.origin.span, (self.written("default", step),))
        if step.kind == "default":
            below.append(ExplanationStep(f'default="{_short(step.written)}" is not used', step.origin.span))
        return ExplanationStep(text, step.origin.span, tuple(below))

    def passed_layer(self, step: ArgumentStep) -> ExplanationStep:
        outside, include = step.origin.includes[:-1], step.origin.includes[-1]
        for passed in self.passed:
            if (passed.name, passed.passed_to, passed.origin.includes) == (step.name, include, outside):
                text = f'passed by the including file: {passed.kind}="{_short(passed.written)}"'
                return ExplanationStep(text, passed.origin.span, self.uses(passed.written, outside, include))
        return ExplanationStep(
            "passed on by pass_all_args", include, tuple(self.argument_in(step.name, outside, include))
        )

    def written(self, attribute: str, step: ArgumentStep) -> ExplanationStep:
        below = self.uses(step.written, step.origin.includes, step.origin.span, without=step.name)
        return ExplanationStep(f'{attribute}="{_short(step.written)}"', None, below)

    def tag_layer(self, origin: Origin) -> ExplanationStep:
        element = self.element_at(origin.span)
        if element is None:
            return ExplanationStep(_short(origin.span.text) or "set here", origin.span)
        tag = " ".join(element.tag_span.text.split())
        below = [
            layer
            for value in element.attributes.values()
            if "$(" in value
            for layer in self.uses(value, origin.includes, origin.span)
        ]
        return ExplanationStep(_short(tag), origin.span, (*dict.fromkeys(below), *self.namespaces(element)))

    def includes(self, origin: Origin) -> Iterator[ExplanationStep]:
        for step in reversed(origin.includes):
            element = self.element_at(step)
            namespace = element.attributes.get("ns") if element is not None else None
            yield ExplanationStep(
                f'included from here, into ns="{namespace}"' if namespace else "included from here", step
            )

    def namespaces(self, element: Element) -> Iterator[ExplanationStep]:
        top = self.trees.get(element.source.path)
        while top is not None and top is not element:
            inner = next((child for child in top.elements if child.start <= element.start <= child.end), None)
            inner = inner or next((child for child in top.elements if child.start == element.start), None)
            if inner is not None and inner is not element and "ns" in inner.attributes:
                yield ExplanationStep(f'inside <{inner.name} ns="{inner.attributes["ns"]}">', inner.span)
            top = inner

    def uses(self, text: str, includes: tuple[Span, ...], near: Span, without: str = "") -> tuple[ExplanationStep, ...]:
        names = [name for name in dict.fromkeys(_arguments_in(text)) if name != without]
        return tuple(layer for name in names for layer in self.argument_in(name, includes, near))

    def argument_in(self, name: str, includes: tuple[Span, ...], near: Span) -> Iterator[ExplanationStep]:
        same = [
            step
            for step in self.declared
            if step.name == name and step.origin.includes == includes and step.origin.span.file.path == near.file.path
        ]
        if same:
            yield self.explain_argument(same[-1])

    def element_at(self, span: Span) -> Element | None:
        path = span.file.path
        if path not in self.trees:
            try:
                self.trees[path] = parse_launch_file(path, self.world.read_bytes(path)).root
            except OSError:
                self.trees[path] = None
        stack = [self.trees[path]]
        while stack:
            element = stack.pop()
            if element is not None:
                if element.start == span.start and element.source.text == span.file.text:
                    return element
                stack.extend(element.elements)
        return None


def _means(wanted: str, full_name: str) -> bool:
    return full_name == wanted or full_name.endswith("/" + wanted)


def _arguments_in(text: str) -> Iterator[str]:
    try:
        pieces = parse_substitutions(text)
    except SubstitutionProblem:
        return
    for piece in pieces:
        if is_eval(text):
            yield from _WORD.findall(piece.content)
        elif piece.command == "arg":
            yield from (word.text for word in piece.words)


def _short(text: str) -> str:
    text = " ".join(text.split())
    return text if len(text) <= _LONG else text[: _LONG - 3] + "..."
