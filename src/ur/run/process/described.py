"""The command line of a node as launch_ros makes it, argument for argument, with the parameter files that it writes.

Sources: launch_ros' `Node._perform_substitutions` and `_create_params_file_from_dict`, launch's `Executable.prepare`.
"""

import os
import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from ur.launchfile.plan.specs import ActionSpec, NodeSpec, ParameterFile, ParamValue, Plan, ReadyCondition, Trigger
from ur.launchfile.plan.written import LOG_FOLDER, WrittenFiles
from ur.launchfile.ros2.parameters import TypedList
from ur.launchfile.world import World
from ur.run.process.command import PRIVATE, UnitProgram, find_executable
from ur.run.process.steps import Planned as PlannedStep
from ur.run.supervisor.planned import list_triggers
from ur.run.supervisor.state import CancelPlanned, Effect, EndPlanned, Planned, PrintPlanned, StartPlanned, Unit
from ur.source.data_classes import replace
from ur.source.diagnostic import Diagnostic, Note, UserError, error

_FOLDER = "parameters"
_RUN = PRIVATE.rstrip("/")


def refuse_gaps(plan: Plan) -> None:
    """Raise UserError for what a plan does not know: it would not start all of the file, or something else."""
    problems = []
    for gap in plan.gaps:
        span = gap.origin.span if gap.origin is not None else None
        steps = gap.origin.includes if gap.origin is not None else ()
        problems.append(
            error(
                f"'ur launch' does not know this part of the launch file: {gap.reason}",
                span,
                rule="unknown-part",
                notes=tuple(Note("included from here", step) for step in reversed(steps)),
                help=f"give the value as an argument, or start the file with: ur launch -- {plan.launcher} ...",
            )
        )
    if problems:
        raise UserError(*problems)


def describe_programs(
    plan: Plan, nodes: Sequence[NodeSpec], world: World
) -> tuple[tuple[UnitProgram, ...], tuple[Diagnostic, ...]]:
    """Return the programs of nodes, and an error for each that does not exist. Nothing is started or written."""
    written = WrittenFiles(plan.written)
    programs = []
    problems: list[Diagnostic] = []
    for number, node in enumerate(nodes, 1):
        try:
            programs.append(describe_program(node, world, number, written))
        except UserError as problem:  # noqa: PERF203 - every node that is missing is to be named
            problems.extend(problem.diagnostics)
    return tuple(programs), tuple(problems)


def describe_program(node: NodeSpec, world: World, number: int, written: WrittenFiles) -> UnitProgram:
    """Return the program of a node. Raises UserError: no such package or executable, or a prefix that is no command."""
    command = _find_command(node, world)
    name = f"{node.key.lstrip('/').replace('/', '-')}-{number}"
    files: dict[str, str] = {}
    arguments = () if node.kind == "program" else _ros_arguments(node, f"{_FOLDER}/{name}", files)
    try:
        prefix = shlex.split(node.launch_prefix or "")
    except ValueError as problem:
        message = f"{node.key}: prefix {node.launch_prefix!r} is no command: {str(problem).lower()}"
        raise UserError(error(message, node.origin.span, rule="bad-arguments")) from None
    program = UnitProgram(
        unit=Unit(
            name=node.key,
            required=node.required,
            respawn=node.respawn,
            respawn_delay=node.respawn_delay,
            terminal=node.terminal,
            planned=node.trigger is not None,
            retries=node.retries,
        ),
        argv=(*prefix, *command, *node.words, *arguments),
        changes=(*((each, None) for each in node.unset), *node.env),
        cwd=node.cwd if node.cwd is not None else os.getcwd(),  # noqa: PTH109 - as upstream: where the user is
        log_name=name,
        screen=node.output == "screen",
        emulates_terminal=node.emulates_terminal,
        ready=() if node.is_named and node.kind != "program" else (ReadyCondition("process", ""),),
        executable=command[0],
        names_log=False,
        files=tuple(files.items()),
    )
    return add_written(program, written)


def add_written(program: UnitProgram, written: WrittenFiles) -> UnitProgram:
    """Return a program with the files that its texts name, and these texts with the paths that it gets."""
    files: dict[str, str] = {}

    def move(text: str) -> str:
        return written.move(text, _RUN, files).replace(LOG_FOLDER, _RUN)

    own = {name: move(text) for name, text in program.files or ()}
    changes = tuple((name, None if value is None else move(value)) for name, value in program.changes)
    cwd = None if program.cwd is None else move(program.cwd)
    argv = tuple(map(move, program.argv))
    return replace(program, argv=argv, changes=changes, cwd=cwd, files=tuple({**own, **files}.items()))


def _find_command(node: NodeSpec, world: World) -> tuple[str, ...]:
    if not node.package:
        return (node.type,)
    try:
        return (find_executable(node, world),)
    except UserError:
        from ur.run.process.sources import find_source_program  # only for packages that are not built

        found = find_source_program(node, world)
        if not found:
            raise
        return found


def _ros_arguments(node: NodeSpec, stem: str, files: dict[str, str]) -> tuple[str, ...]:
    words = ["--ros-args"]
    words += ["-r", f"__node:={node.name}"] if node.is_named else []
    words += ["-r", f"__ns:={node.namespace.rstrip('/') or '/'}"] if node.is_placed else []
    for source in node.sources:
        if isinstance(source, ParameterFile):
            words += ["--params-file", source.argument or source.path]
        elif source.is_global:
            words += [word for each in source.values for word in ("-p", f"{each[0]}:={_python(each[1])}")]
        elif source.is_rule:
            words += [word for each in source.values for word in ("-p", f"{each[0]}:={_yaml(_python(each[1]))}")]
        else:
            section = node.full_name if node.is_named and node.is_placed else "/**"
            content = {section: {"ros__parameters": {each: _python(value) for each, value in source.values}}}
            words += ["--params-file", _add(files, stem, _yaml(content))]
    for old, new in node.remaps:
        words += ["-r", f"{old}:={new}"]
    return tuple(words)


def _add(files: dict[str, str], stem: str, text: str) -> str:
    name = f"{stem}-{len(files) + 1}.yaml"
    files[name] = text
    return PRIVATE + name


def _python(value: ParamValue) -> object:
    if not isinstance(value, list):
        return value
    return list(value) if isinstance(value, TypedList) else tuple(value)


def _yaml(value: object) -> str:
    import yaml  # only for nodes with such parameters

    text: str = yaml.dump(value, default_flow_style=False)
    return text


def plan_effects(
    plan: Plan,
    nodes: Sequence[NodeSpec],
    steps: Sequence[PlannedStep] = (),
    awaited: Mapping[int, Trigger] | None = None,
) -> tuple[Planned, ...]:
    """Return the effects of events: which nodes and steps start, which lines are printed, which end the run.

    As upstream, the handler of an event that was registered last comes first. `awaited` replaces triggers by their ids.
    """
    items: list[tuple[float, Trigger | None, Effect | CancelPlanned]] = [
        (action.position + 0.5, action.trigger, _effect_of(action))  # behind that node
        for action in plan.actions
        if action.kind != "state"
    ]
    present = {node.key for node in nodes}
    for position, node in enumerate(plan.nodes, 1):
        if node.trigger is not None and node.key in present:
            items.append((position, node.trigger, StartPlanned(node.key)))
    items += [(position, trigger, StartPlanned(program.unit.name)) for program, trigger, position in steps]
    handlers: dict[int, list[Planned]] = {}
    others: list[Planned] = []
    for _, trigger, effect in sorted(items, key=lambda item: item[0]):
        into = others if trigger is None or trigger.kind == "timer" else handlers.setdefault(id(trigger), [])
        triggers = (awaited or {}).get
        into.append(Planned(effect, tuple(triggers(id(each), each) for each in list_triggers(trigger))))
    return (*others, *(each for handler in reversed(handlers.values()) for each in handler))


def _effect_of(action: ActionSpec) -> Effect | CancelPlanned:
    match action.kind:
        case "log":
            return PrintPlanned(action.text)
        case "unregister":
            return CancelPlanned(int(action.text))
    return EndPlanned(action.text)


def write_files(program: UnitProgram, folder: str) -> UnitProgram:
    """Write the private files of a program, and return it with their paths. Raises UserError."""

    def place(text: str) -> str:
        return text.replace(_RUN, folder)

    try:
        for name, text in program.files or ():
            path = Path(folder, name)
            path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
            path.write_text(place(text), encoding="utf-8")
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        message = f"parameters cannot be written to {folder}: {reason}"
        raise UserError(error(message, rule="bad-folder", help="ROS_LOG_DIR chooses another place")) from None
    changes = tuple((name, None if value is None else place(value)) for name, value in program.changes)
    cwd = None if program.cwd is None else place(program.cwd)
    return replace(program, argv=tuple(map(place, program.argv)), changes=changes, cwd=cwd)


def place_lines(planned: Sequence[Planned], plan: Plan, folder: str) -> tuple[Planned, ...]:
    """Return what events cause, with the paths of the run's folder in the lines that are printed."""
    written = WrittenFiles(plan.written)

    def place(each: Planned) -> Planned:
        if not isinstance(each.effect, PrintPlanned):
            return each
        text = written.move(each.effect.text, folder, {}).replace(LOG_FOLDER, folder)
        return replace(each, effect=PrintPlanned(text))

    return tuple(map(place, planned))
