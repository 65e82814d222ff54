"""Comparison of two launch files by what they start, with the values of arguments that decide something."""

import difflib
from collections.abc import Iterator, Mapping
from dataclasses import fields

from ur.launchfile.plan.specs import ArgumentStep, NodeSpec, ParameterValues, Plan, TraceStep, describe_trigger
from ur.launchfile.ros2.load import load_ros2
from ur.launchfile.world.overlay import OverlayWorld
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import Severity

_FLIPPED = {"true": "false", "false": "true", "True": "False", "False": "True"}
_MOST_CASES = 60
_UNCLEAR = ("error", "not known: it raises")  # as where another variable leads to no file
_APART = frozenset({"name", "namespace", "origin", "sources", "words", "trigger", "args"})


class OtherVariables(OverlayWorld):
    """A world in which some environment variables have other values."""

    def __init__(self, world: World, texts: Mapping[str, bytes], variables: Mapping[str, str]) -> None:
        super().__init__(world, texts)
        self._variables = {**world.environment, **variables}

    @property
    def environment(self) -> Mapping[str, str]:
        return self._variables


def compare_plans(
    path: str, other: str, text: str, world: World, variables: Mapping[str, bool]
) -> tuple[str, tuple[str, ...]] | None:
    """Compare a launch file with another, whose `text` is not written yet.

    Return the arguments with which they differ, and the lines that do: `- ` has the first file, `+ ` the other; None if
    the plans are equal with the defaults, with each flag reversed, with each choice, and with other values of the
    `variables`, of which those that are True must be set.
    """
    texts = {other: text.encode()}
    others = dict.fromkeys(variables, "another")
    unset = {name: "another" for name, needed in variables.items() if needed and name not in world.environment}
    base = OtherVariables(world, texts, unset)
    for each in (base, *([OtherVariables(world, texts, others)] if others else [])):
        trace: list[TraceStep] = []
        load_ros2(path, (), each, trace)
        steps = [each for each in trace if isinstance(each, ArgumentStep) and not each.origin.includes]
        required = tuple(f"{each.name}:=value" for each in steps if each.kind == "required" and not each.choices)
        cases: list[tuple[str, ...]] = [(), required] if required else [()]
        for step in steps:
            values = step.choices or [_FLIPPED.get(step.value or "", "")]
            cases += [(*required, f"{step.name}:={value}") for value in values if value and value != step.value]
        for arguments in cases[:_MOST_CASES]:
            first, second = (_describe_file(file, arguments, each) for file in (path, other))
            if first != second and (each is base or not any(line.startswith(_UNCLEAR) for line in first)):
                changes = difflib.unified_diff(first, second, lineterm="", n=0)
                lines = tuple(line[0] + " " + line[1:] for line in changes if line[:3] not in ("---", "+++", "@@ "))
                return " ".join(arguments), lines
    return None


def _describe_file(path: str, arguments: tuple[str, ...], world: World) -> list[str]:
    trace: list[TraceStep] = []
    plan = load_ros2(path, arguments, world, trace)
    steps = (each for each in trace if isinstance(each, ArgumentStep))
    declared = [
        f"argument {each.name} = {each.value!r} {each.kind} {each.choices} {'' if each.origin.includes else each.doc!r}"
        for each in steps
    ]
    return [*declared, *_describe_plan(plan)]


def _describe_plan(plan: Plan) -> Iterator[str]:
    for include in plan.includes:
        yield f"include {include.file} in {include.namespace} with {dict(include.arguments)}"
    for node in plan.nodes:
        yield from (f"{node.kind} {node.full_name}: {line}" for line in _describe_node(node))
    for name, value in plan.environment:
        yield f"variable {name} = {value!r}"
    yield from sorted({f"not known: {gap.reason}" for gap in plan.gaps})
    errors = [found for found in plan.diagnostics if found.severity is Severity.ERROR]
    yield from sorted(f"error {found.rule} {found.subject}" for found in errors)


def _describe_node(node: NodeSpec) -> Iterator[str]:
    for each in fields(node):
        value = getattr(node, each.name)
        if each.name not in _APART and value != each.default:
            yield f"{each.name} = {value!r}"
    yield f"arguments = {node.words!r}"
    if node.trigger is not None:
        yield f"starts {describe_trigger(node.trigger)}"
    for source in node.sources:
        if isinstance(source, ParameterValues):
            yield from (f"parameter {name} = {value!r}" for name, value in source.values)
        else:
            yield f"parameters of {source.path}"
