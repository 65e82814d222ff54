"""Loader of launch files of ROS 2: from a file and arguments to a Plan."""

from collections.abc import Sequence

from ur.launchfile.plan.commands import RunWith
from ur.launchfile.plan.draft import Draft, TooMuch
from ur.launchfile.plan.specs import Plan, TraceStep
from ur.launchfile.plan.values.budget import Budget, TooLong
from ur.launchfile.ros2.context import MOST_BYTES, Context
from ur.launchfile.ros2.model import Description, DescriptionProblem, Unknown
from ur.launchfile.ros2.python import one_expression as one_expression  # which adds itself to the substitutions
from ur.launchfile.ros2.python.reader import read_python
from ur.launchfile.ros2.visit import Visitor
from ur.launchfile.world.protocol import World
from ur.source.arguments import Argument, parse_argument
from ur.source.diagnostic import error, error_about
from ur.source.file import SourceFile, Span
from ur.source.suggest import did_you_mean

PER_LAUNCH = 20_000_000  # units of work for a file with all that it includes


def load_ros2(
    path: str,
    arguments: Sequence[str],
    world: World,
    trace: list[TraceStep] | None = None,
    budget: Budget | None = None,
    run: RunWith | None = None,
) -> Plan:
    """Resolve a launch file of ROS 2, with `NAME:=VALUE` arguments, as `ros2 launch` does. Nothing of it is executed.

    `run` runs the commands whose output is a value; without it that output is a gap.
    Never raises for its content: the plan's diagnostics have what upstream refuses, its gaps what reading alone does
    not find out.
    """
    given = [parse_argument(each) or Argument(each, "") for each in arguments]
    values = {each.name: each.value for each in given if each.name and each.value}
    malformed = [text for text, each in zip(arguments, given, strict=True) if not each.name or not each.value]
    draft = Draft(world, trace)
    context = Context(world, budget or Budget(PER_LAUNCH), values)
    context.run_command = run
    visitor = Visitor(context, draft, read_description)
    context.file = world.absolute(path)
    draft.files[context.file] = None
    try:
        visitor.start(read_description(context.file, context))
        _check_arguments(values, malformed, visitor, draft)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        help_ = context.near_file(context.file) or "give the path of a launch file that you may read"
        draft.add_diagnostic(
            error_about(path, f"{reason}, expected a launch file", rule="missing-file", help=help_), ()
        )
    except TooMuch:
        pass
    except TooLong as problem:
        context.add_gap(Unknown(f"the file {problem}"))
    except RecursionError:
        draft.diagnostics.append(error("nested too deep", rule="nested-too-deep", help="nest groups and includes less"))
    return visitor.finish()


def read_description(path: str, context: Context) -> Description:
    """Read a launch file in the language that its name tells. Raises OSError."""
    data = context.read(path)
    if len(data) > MOST_BYTES and path.endswith(
        (".py", ".py.in", ".yaml", ".yml")
    ):  # the reader of XML has its own limit
        return Description(path, None, (_too_large(path, len(data)),))
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return Description(path, None, (_not_text(path),))
    if path.endswith((".py", ".py.in")):
        return read_python(path, text, context)
    from ur.launchfile.ros2.entities import read_entities

    return read_entities(path, text)


def _too_large(path: str, size: int) -> DescriptionProblem:
    message = f"{path} has {size:,} bytes, expected a launch file of at most {MOST_BYTES:,}"
    return DescriptionProblem(message, "file-too-large", Span(SourceFile(path, ""), 0, 0), "split it", path)


def _not_text(path: str) -> DescriptionProblem:
    span = Span(SourceFile(path, ""), 0, 0)
    return DescriptionProblem(f"{path}: not UTF-8, expected a text", "unreadable-file", span, "save it as UTF-8", path)


def _check_arguments(values: dict[str, str], malformed: list[str], visitor: Visitor, draft: Draft) -> None:
    for name in values:
        if name not in visitor.declared and not draft.diagnostics:
            near = did_you_mean(name, visitor.declared)
            known = ", ".join(sorted(visitor.declared)) or "none"
            draft.warn(
                f"argument '{name}' is given, but the launch file does not declare it", None, None, "unknown-argument",
                f"did you mean {near}:=...?" if near else f"declared: {known}",
            )  # fmt: skip
    for argument in malformed:
        draft.add_diagnostic(error(f"'{argument}' is malformed, expected NAME:=VALUE", rule="bad-argument"), ())
