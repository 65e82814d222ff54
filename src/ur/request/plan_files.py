"""From a request to a plan, with printed findings."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

from ur.launchfile.load import load_plan
from ur.launchfile.plan.problems import NOT_GIVEN
from ur.launchfile.plan.specs import MachineSpec, NodeSpec, Origin, Plan
from ur.launchfile.query.explain import list_nodes
from ur.launchfile.world.protocol import World
from ur.launchfile.world.system import SystemWorld
from ur.request.environment import apply_selection, current_selection
from ur.request.launch_request import LaunchOptions, LaunchRequest, Report, make_request
from ur.request.worlds import check_worlds, resolve_worlds
from ur.robot.selection import Selection
from ur.source.arguments import Argument, split_argv, values_of
from ur.source.diagnostic import Diagnostic, Severity, UserError, error, user_error
from ur.source.file import SourceFile, Span
from ur.source.suggest import did_you_mean, suggest

if TYPE_CHECKING:
    from ur.request.bases.base_argument import FileBase

_MAP = "map"
_OTHERS = ("map_file", "world")

Inspect = Callable[[Iterable[Diagnostic]], None]


class LoadedPlan(NamedTuple):
    """The plan of a request; None if it has errors. `arguments` are complete: with those of the selection.

    `robot` is the machine whose nodes belong to the selected robot, if that is another computer; '' otherwise.
    `findings` have been printed.
    """

    request: LaunchRequest
    plan: Plan | None
    arguments: tuple[Argument, ...] = ()
    robot: str = ""
    findings: tuple[Diagnostic, ...] = ()

    @property
    def world(self) -> World:
        """The world in which the plan was made."""
        return self.request.files.world


def complete_arguments(request: LaunchRequest, *, local: bool) -> tuple[Argument, ...]:
    """Return the arguments of a request, with those that the selection adds, and absolute paths of worlds.

    A selection adds arguments that the files declare and that are not given; without one the arguments are complete.
    `local`: this computer is the robot. Raises UserError for a world that cannot be used on the robot.
    """
    selection, declared = request.selection, request.files.declared
    if selection is None:
        return request.arguments
    remote = not local and "robot_machine" in declared and "robot_machine" not in request.values
    named = resolve_map(request.arguments, declared, real=not selection.simulated, remote=remote)
    given = resolve_worlds(named, request.files.paths, declared, selection.robot if remote else "")
    return (*given, *selected_arguments(selection, declared, values_of(given), local=local))


def load_request(request: LaunchRequest, inspect: Inspect | None = None) -> LoadedPlan:
    """Load the plan of a request, and print its errors to standard error. `inspect` is called with them before.

    Arguments about the robot that are declared and not given are taken from the selection, except for a robot's share
    of a run (`part`): its arguments are complete, and `part` is a machine that the file need not define: this computer.
    Raises UserError for a value of the wrong type, an unknown base or one that does not meet the file's needs, or a
    missing driver package.
    """
    part, selection, files = request.options.part, request.selection, request.files
    assert selection is not None
    local = part is not None or selection.simulated or is_this_computer(selection.robot)
    given = request._replace(selection=None) if part is not None else request
    arguments = complete_arguments(given, local=local)
    values = values_of(arguments)
    remote = not local and values.get("robot_machine") == selection.robot
    bases: tuple[FileBase, ...] = ()
    if "robot_base" in values and "robot_base" in files.declared:
        from ur.request.bases.base_argument import (  # reads YAML, which most launch files do without
            check_bases,
            find_bases,
        )

        bases = find_bases(files, values)
        check_bases(files, bases)
    arguments = (*arguments, *localisation_argument(request, arguments, bases))
    computers = [describe_computer(selection.robot, f"{selection.robot}.local")] if remote else []
    computers += [describe_computer(part, "localhost")] if part is not None else []
    plan = files.load(texts(arguments), computers)
    findings = plan.diagnostics
    if any(node.terminal for node in plan.nodes):
        findings = tuple(map(_harden, findings))
    if any(each.severity is Severity.ERROR for each in findings):

        def replan(given: Sequence[Argument]) -> Plan:
            kept = {each.name for each in given}
            left = [each for each in arguments if each.name in kept or each.name not in request.values]
            return load_plan(files.paths, texts(left), files.world, computers=computers, parsed=files.parsed)

        if wrong := blame_arguments(findings, request.arguments, replan):
            raise UserError(*wrong)
    if inspect is not None:
        inspect(findings)
    show_findings(findings)
    if bases and values.get("simulate") == "false" and not remote:
        from ur.request.bases.base_argument import check_drivers

        check_drivers(bases, plan.nodes, files.world)
    good = not any(each.severity is Severity.ERROR for each in findings)
    if good:
        check_worlds(plan)
    return LoadedPlan(request, plan if good else None, arguments, selection.robot if remote else "", findings)


def load_tolerantly(argv: Sequence[str]) -> tuple[Plan, list[str], bool]:
    """Return the plan of `[PACKAGE] FILE [ARG:=VALUE]...`, the absolute paths of its files, and whether it is valid.

    Arguments that are declared and not given are taken from the selection. Findings are printed to standard error.
    Raises UserError for a missing file, or a name that is neither a file nor an argument.
    """
    from ur.source.progress_line import show_progress

    selection = current_selection(os.environ)
    apply_selection(selection)
    world = make_world()
    with show_progress(f"reading {' '.join(argv)}"):
        request = make_request(split_argv(argv), world, selection)
        files = request.files
        plan = files.load(texts(complete_arguments(request, local=True)))
    show_findings(plan.diagnostics)
    sound = not any(found.severity is Severity.ERROR for found in plan.diagnostics)
    return plan, [world.absolute(path) for path in files.paths], sound


def show_findings(findings: Iterable[Diagnostic]) -> None:
    """Print findings on standard error."""
    shown = list(findings)
    if shown:
        from ur.source.render import render_human, shows_colour

        sys.stderr.write(render_human(shown, colour=shows_colour(sys.stderr)))
        sys.stderr.flush()


def make_world() -> SystemWorld:
    """Return the world of this process's environment, in which nodes run."""
    return SystemWorld(os.environ, standard_input=lambda: sys.stdin.buffer.read())


def texts(arguments: Iterable[Argument]) -> list[str]:
    """Return arguments in the form of roslaunch."""
    return [str(each) for each in arguments]


def describe_computer(name: str, address: str) -> MachineSpec:
    """Return a machine that no launch file has to define."""
    origin = Origin(Span(SourceFile("<selection>", name), 0, len(name)))
    return MachineSpec(name, address, user=None, env_loader=None, ssh_port=22, timeout=10.0, origin=origin)


def selected_arguments(
    selection: Selection, declared: Collection[str], given: Collection[str], *, local: bool
) -> list[Argument]:
    """Return the arguments that a selection adds: those that are declared and not given.

    `local`: this computer is the robot. A robot that is another computer is a machine with its name.
    """
    values = {
        "robot_base": selection.base,
        # A variant belongs to its base: with another base given by hand it means nothing.
        "robot_variant": "" if "robot_base" in given else selection.variant,
        "robot_machine": "localhost" if local else selection.robot,
        "viewer_machine": "localhost",
        "simulate": "" if selection.simulated else "false",
    }
    return [Argument(name, value) for name, value in values.items() if value and name in declared and name not in given]


def localisation_argument(
    request: LaunchRequest, arguments: Iterable[Argument], bases: tuple[FileBase, ...] = ()
) -> list[Argument]:
    """Return the argument of `choose_localisation` for a request; `bases` saves loading them. Raises UserError."""
    if "localisation" not in request.files.declared:
        return []
    from ur.request.bases.base_argument import find_bases
    from ur.request.bases.localisation import choose_localisation  # reads YAML

    values = values_of(arguments)
    return choose_localisation(values, lambda: bases or find_bases(request.files, values))


def is_this_computer(robot: str) -> bool:
    """Return whether a robot's name is that of this computer."""
    return os.uname().nodename.split(".")[0].lower() == robot.lower()


def _harden(finding: Diagnostic) -> Diagnostic:
    # A program takes the screen: a mere warning about a misspelt argument would never be read.
    if finding.rule not in ("unknown-argument", "bad-argument"):
        return finding
    return finding._replace(severity=Severity.ERROR)


def resolve_map(
    arguments: Sequence[Argument], declared: Collection[str], *, real: bool, remote: bool
) -> tuple[Argument, ...]:
    """Check the map of a launch file with the arguments `map` and `map_file`.

    Without one, a real robot uses its latest map. `remote`: the map is on another computer. Raises UserError if this
    computer does not have the map.
    """
    if _MAP not in declared or "map_file" not in declared:
        return tuple(arguments)
    values = values_of(arguments)
    if name := values.get(_MAP, ""):
        if "map_file" in values:
            return tuple(arguments)
        from ur.maps.names import LATEST, check_map_name  # most launches name no map
        from ur.maps.store import own_store

        store = own_store(os.environ)
        resolved = (name if name == LATEST else check_map_name(name)) if remote else store.resolve(name)
        return tuple(Argument(_MAP, resolved) if each.name == _MAP else each for each in arguments)
    if not real or _MAP in values or any(other in values for other in _OTHERS) or values.get("simulate") == "true":
        return tuple(arguments)
    if values.get("localisation") == "fiducials":
        return tuple(arguments)
    from ur.maps.names import LATEST
    from ur.maps.store import own_store

    found = LATEST if remote else own_store(os.environ).latest()
    return (*arguments, Argument(_MAP, found)) if found else tuple(arguments)


def load_chosen(request: LaunchRequest, report: Report, inspect: Inspect | None = None) -> LoadedPlan:
    """Load a request, and apply the options that choose nodes; errors in the files are printed.

    `inspect` is called with the errors before. Raises UserError, as `load_request` does, and for unknown nodes in
    options.
    """
    if request.options.core:
        return LoadedPlan(request, Plan((), (), (), (), (), ("core",)))
    loaded = load_request(request, inspect)
    if loaded.plan is None:
        return loaded
    return loaded._replace(plan=apply_options(loaded.plan, request.options, report))


def apply_options(plan: Plan, options: LaunchOptions, report: Report) -> Plan:
    """Return a plan with the nodes that options choose. Raises UserError for unknown nodes in options."""
    if options.local:
        from ur.run.paths import is_local_address
        from ur.run.startup.node_selection import split_plan

        plan, remote = split_plan(plan, is_local_address)
        for each in remote:
            names = ", ".join(node.full_name for node in each.nodes)
            report("warning", f"--local: {names} for {each.machine.name} ({each.machine.address}) left out")
    if options.only or options.except_ or options.prefix:
        plan = choose_nodes(plan, options.only, options.except_, options.prefix)
    if options.no_terminal:
        left_out = [node.full_name for node in plan.nodes if node.terminal]
        plan = plan._replace(nodes=tuple(node for node in plan.nodes if not node.terminal))
        if left_out:
            report("info", f"--no-terminal: {', '.join(left_out)} left out")
    for node in plan.nodes if options.required else ():
        if node.respawn:
            message = f"--required: {node.full_name} is to be respawned, expected a node that may end"
            raise user_error(message, node.origin.span, rule="required-respawn")
    if options.verbose:
        report("info", "\n".join(_list_contents(plan)))
    if options.part is not None:
        from ur.run.startup.node_selection import keep_nodes

        mine = {node.full_name for node in plan.nodes if node.machine == options.part} - set(options.runs_already)
        plan = keep_nodes(plan, mine)
        plan = plan._replace(commands=tuple(each for each in plan.commands if each.command != "dump"))
    return plan


def choose_nodes(plan: Plan, only: Sequence[str], without: Sequence[str], prefixes: Sequence[str]) -> Plan:
    """Return a plan with `only` these nodes (empty: all), `without` others, some with a `NODE=PREFIX`.

    Raises UserError for a node that is not in the plan, and for a prefix without its node.
    """
    kept = {find_node(plan, name).full_name for name in only} or {node.full_name for node in plan.nodes}
    kept -= {find_node(plan, name).full_name for name in without}
    before = {}
    for text in prefixes:
        name, found, prefix = text.partition("=")
        if not found:
            raise user_error(f"--prefix {text!r}, expected NODE=PREFIX", rule="bad-prefix", subject=text)
        before[find_node(plan, name).full_name] = prefix
    nodes = (
        node._replace(launch_prefix=before.get(node.full_name, node.launch_prefix))
        for node in plan.nodes
        if node.full_name in kept
    )
    return plan._replace(nodes=tuple(nodes))


def _list_contents(plan: Plan) -> Iterator[str]:
    yield from (f"file {path}" for path in plan.files)
    yield from (f"parameter {each.name}: {each.command or each.value!r}" for each in plan.params)
    yield from (f"node {node.full_name} ({node.package}/{node.type})" for node in plan.nodes)


# By rule, or by rule and kind: the expected value.
_EXPECTED = {
    ("bad-boolean", ""): "true or false",
    ("bad-number", ""): "a number",
    ("bad-number", "double"): "a number",
    ("bad-param-value", "double"): "a number",
    ("bad-param-value", "int"): "a whole number",
    ("bad-param-value", "bool"): "true or false",
    ("bad-param-value", "boolean"): "true or false",
}
_BOOLEANS = {"yes": "true", "on": "true", "y": "true", "no": "false", "off": "false", "n": "false"}


def blame_arguments(
    findings: Sequence[Diagnostic], given: Sequence[Argument], replan: Callable[[Sequence[Argument]], Plan]
) -> tuple[Diagnostic, ...]:
    """Return errors about the arguments that cause errors about values in launch files, one for each argument.

    An argument causes an error if the error vanishes with the argument's default. `replan` makes the plan with given
    arguments; it is called only if there is such an error.
    """
    blamed: list[Diagnostic] = []
    left, current = list(given), tuple(findings)
    for _ in given:  # an error may hide the one of an argument before it
        for argument in tuple(left):
            if not any(map(_expectation, current)):
                return tuple(blamed)
            others = [each for each in left if each.name != argument.name]
            without = replan(others).diagnostics
            places = set(map(_place, without))
            expected = next(
                (_expectation(each) for each in current if _expectation(each) and _place(each) not in places), ""
            )
            if expected and not any(found.kind == NOT_GIVEN for found in without):
                blamed.append(_about(argument, expected))
                left, current = others, without
    return tuple(blamed)


def _about(argument: Argument, expected: str) -> Diagnostic:
    help_ = None
    if expected == "true or false":
        near = _BOOLEANS.get(argument.value.lower()) or did_you_mean(argument.value, ("true", "false"))
        help_ = f"did you mean {argument.name}:={near}?" if near else f"for example {argument.name}:=false"
    return error(
        f"argument '{argument.name}' is '{argument.value}', expected {expected}",
        rule="bad-argument",
        help=help_,
        subject=argument.name,
    )


def _expectation(found: Diagnostic) -> str:
    return _EXPECTED.get((found.rule, found.kind), "") if found.severity is Severity.ERROR else ""


def _place(found: Diagnostic) -> tuple[str, str]:
    return found.rule, str(found.span or found.message)


def find_node(plan: Plan, name: str) -> NodeSpec:
    """Return the node or test with this name, with or without leading slash. Raises UserError if none or two match."""
    full = name if name.startswith(("/", "$")) else "/" + name
    found = [node for node in plan.all_nodes() if node.name and full in (node.full_name, node.name)]
    if len(found) == 1:
        return found[0]
    if found:
        raise user_error(f"{len(found)} tests are named {full}, expected names to differ", rule="duplicate-node")
    names = list_nodes(plan)
    raise user_error(
        f"unknown node {name!r}, expected one of {', '.join(names) or '(none)'}",
        rule="unknown-node",
        help=suggest(full, names),
        subject=name,
    )
