"""Loader of launch files of ROS 1: from files and arguments to a Plan."""

from collections.abc import Sequence

from ur.launchfile.plan.draft import Draft, TooMuch
from ur.launchfile.plan.names import initial_namespace, read_assignments
from ur.launchfile.plan.problems import refuse
from ur.launchfile.plan.scope import Scope
from ur.launchfile.plan.specs import MachineSpec, Plan, TraceStep
from ur.launchfile.plan.tags.body import resolve_file
from ur.launchfile.plan.values.budget import Budget
from ur.launchfile.syntax import LaunchFile
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import error, error_about
from ur.source.file import SourceFile, Span
from ur.source.suggest import did_you_mean, suggest

STANDARD_INPUT = "-"


def load_ros1(
    files: Sequence[str],
    arguments: Sequence[str],
    world: World,
    trace: list[TraceStep] | None = None,
    trees: dict[str, LaunchFile] | None = None,
    computers: Sequence[MachineSpec] = (),
    budget: Budget | None = None,
    parsed: dict[str, LaunchFile] | None = None,
) -> Plan:
    """Resolve launch files together, with `NAME:=VALUE` arguments, exactly as roslaunch does.

    See `load_plan` for the parameters.
    """
    draft = Draft(world, trace, trees, budget=budget, parsed=parsed)
    try:
        values, ignored = read_assignments(arguments)
        declared: set[str] = set()
        for path in sorted(files, key=STANDARD_INPUT.__eq__):  # roslaunch loads it after the files
            _load_file(path, values, arguments, draft, declared)
        _check_arguments(values, ignored, declared, arguments, draft)
        for computer in computers:
            draft.machines.setdefault(computer.name, computer)
        for name, element, scope in draft.machine_uses:
            if name not in draft.machines:
                help_ = suggest(name, draft.machines) or f'define it: <machine name="{name}" address="..."/>'
                draft.refuse(
                    refuse(
                        f"machine '{name}' is not defined, expected a <machine> of this name",
                        element.value_span("machine"),
                        "unknown-machine",
                        help_,
                        subject=name,
                    ),
                    scope,
                )
    except TooMuch:
        pass
    except RecursionError:
        draft.diagnostics.append(error("nested too deep", rule="nested-too-deep", help="nest groups and includes less"))
    return draft.finish()


def _load_file(path: str, values: dict[str, str], arguments: Sequence[str], draft: Draft, declared: set[str]) -> None:
    try:
        parsed = draft.parse(path)
        namespace = initial_namespace(arguments, draft.world.environment)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        folder, slash, name = path.rpartition("/")
        near = did_you_mean(name, (each for each in draft.world.list_folder(folder or ".") if each != name))
        near = None if isinstance(problem, PermissionError) else near
        help_ = f"did you mean {folder}{slash}{near}?" if near else "give the path of a launch file that you may read"
        draft.add_diagnostic(
            error_about(path, f"{reason}, expected a launch file", rule="missing-file", help=help_), ()
        )
        return
    except ValueError as problem:
        draft.add_diagnostic(error(f"starting namespace: {problem}", rule="bad-name"), ())
        return
    if path != STANDARD_INPUT:
        draft.files[draft.world.absolute(path)] = None
    scope = Scope(namespace, path, dict(values))
    resolve_file(parsed, draft, scope)
    declared.update(scope.declared)


def _check_arguments(
    values: dict[str, str], ignored: list[str], declared: set[str], arguments: Sequence[str], draft: Draft
) -> None:
    if any(found.rule in ("bad-xml", "launch-element", "missing-file") for found in draft.diagnostics) and not declared:
        return
    line = SourceFile("<command line>", " ".join(arguments))
    for name in values:
        if name in declared or name.startswith("__"):
            continue
        near = did_you_mean(name, declared - set(values))
        known = ", ".join(sorted(declared)) or "none"
        draft.warn(
            f"argument '{name}' is given, but the launch file does not declare it",
            _place(line, name + ":="),
            None,
            "unknown-argument",
            f"did you mean {near}:=...?" if near else f"declared: {known}",
        )
    for argument in ignored:
        draft.warn(
            f"'{argument}' is ignored, expected NAME:=VALUE with a valid name and a value",
            _place(line, argument),
            None,
            "bad-argument",
        )


def _place(line: SourceFile, text: str) -> Span:
    start = max(line.text.find(text), 0)
    return Span(line, start, start + len(text.removesuffix(":=")))
