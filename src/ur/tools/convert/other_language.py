"""Conversion of one launch file of ROS 2 to XML or YAML, compared with the file that it was made of."""

from dataclasses import replace
from typing import Literal

from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.ros2.context import Context
from ur.launchfile.ros2.load import PER_LAUNCH, read_description
from ur.launchfile.ros2.model import Description
from ur.launchfile.world import World
from ur.source.diagnostic import Diagnostic, Note, Severity, UserError, error_about
from ur.source.file import Span
from ur.tools.convert.backwards import TagWriter
from ur.tools.convert.origins import MarkedWorld
from ur.tools.convert.run import HEAD, Converted
from ur.tools.convert.same_plan import compare_plans
from ur.tools.convert.state import RULE, Findings
from ur.tools.convert.xml_out import write_xml
from ur.tools.convert.yaml_out import write_yaml

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
        raise UserError(error_about(path, reason, rule="missing-file")) from None
    findings = Findings()
    folder = path.rpartition("/")[0]
    writer = TagWriter(lambda text, span: marked.split(text, folder, span), findings)
    root = writer.write_launch(description, context.environment)
    text = HEAD + write_xml(root) if language == "xml" else write_yaml(root)
    target = name_in(path, language)
    tested = [_tested(name, description) for name in sorted(marked.variables.tested)]
    named = [replace(each, message=marked.show(each.message)) for each in findings.finish()]
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
