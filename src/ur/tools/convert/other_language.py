"""Conversion of one launch file of ROS 2 to XML or YAML, compared with its file by what both start."""

import difflib
from collections.abc import Iterator, Mapping
from typing import Literal

from ur.launchfile.plan.specs import ArgumentStep, NodeSpec, ParameterValues, Plan, TraceStep, describe_trigger
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.load import PER_LAUNCH, load_ros2, read_description
from ur.launchfile.ros2.model import Description
from ur.launchfile.world import World
from ur.launchfile.world.overlay import OverlayWorld
from ur.source.diagnostic import Diagnostic, Note, Severity, user_error_about
from ur.source.file import Span
from ur.tools.convert.backwards import TagWriter
from ur.tools.convert.origins import MarkedWorld
from ur.tools.convert.run import HEAD, Converted
from ur.tools.convert.state import RULE, Findings
from ur.tools.convert.yaml_out import write_xml, write_yaml

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
    for name, value in node._asdict().items():
        if name not in _APART and (name not in node._field_defaults or value != node._field_defaults[name]):
            yield f"{name} = {value!r}"
    yield f"arguments = {node.words!r}"
    if node.trigger is not None:
        yield f"starts {describe_trigger(node.trigger)}"
    for source in node.sources:
        if isinstance(source, ParameterValues):
            yield from (f"parameter {name} = {value!r}" for name, value in source.values)
        else:
            yield f"parameters of {source.path}"


Language = Literal["xml", "yaml"]
_MOST_LINES, _WIDEST = 20, 150


def convert_to(path: str, world: World, language: Language) -> Converted:
    """Convert a launch file of ROS 2; `path` is absolute. Raises UserError for a file that cannot be read.

    `findings` name what has no counterpart, with its line; where all has one, the difference of the plans.
    """
    marked = MarkedWorld(world)
    context = Context(marked, Budget(PER_LAUNCH), {})
    context.file = path
    try:
        description = read_description(path, context)
    except OSError as problem:
        reason = f"{(problem.strerror or str(problem)).lower()}, expected a launch file"
        raise user_error_about(path, reason, rule="missing-file") from None
    findings = Findings()
    folder = path.rpartition("/")[0]
    writer = TagWriter(lambda text, span: marked.split(text, folder, span), findings)
    root = writer.write_launch(description, context.environment)
    text = HEAD + write_xml(root) if language == "xml" else write_yaml(root)
    target = name_in(path, language)
    tested = [_tested(name, description) for name in sorted(marked.variables.tested)]
    named = [each._replace(message=marked.show(each.message)) for each in findings.finish()]
    found = list({(each.span, each.message): each for each in (*tested, *named)}.values())
    if not found and (difference := compare_plans(path, target, text, world, marked.variables.used)) is not None:
        found.append(_different(path, *difference))
    return Converted(target, text, (), tuple(found))


def _tested(name: str, description: Description) -> Diagnostic:
    span = None
    if description.launch is not None:
        file = description.launch.span.file
        place = max(file.text.find(name), 0)
        span = Span(file, place, place + len(name))
    message = f"the variable {name} decides while the file is read what it starts, which cannot be converted"
    help_ = f"make it an argument whose default is EnvironmentVariable('{name}'), and use it in conditions"
    return Diagnostic(Severity.WARNING, message, RULE, span, (), help_, name)


def name_in(path: str, language: Language) -> str:
    """Return the path of a launch file in another language."""
    stem = path.removesuffix(".in").rpartition(".")[0]
    if stem.endswith((".launch", "_launch")):
        return f"{stem}.{language}"
    return f"{stem}.launch.{language}"


def _different(path: str, arguments: str, lines: tuple[str, ...]) -> Diagnostic:
    with_ = f" with {arguments}" if arguments else ""
    left = (f"... {len(lines) - _MOST_LINES} more lines",) if len(lines) > _MOST_LINES else ()
    notes = tuple(Note(line[:_WIDEST]) for line in (*lines[:_MOST_LINES], *left))
    message = f"{path}: the converted file does not start the same{with_}"
    help_ = "lines with - are of this file, lines with + of the converted one"
    return Diagnostic(Severity.WARNING, message, "other-plan", None, notes, help_, path)
