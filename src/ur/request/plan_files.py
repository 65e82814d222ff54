"""From a request to a plan, with printed findings."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ur.launchfile.plan.load import load_plan
from ur.launchfile.plan.specs import MachineSpec, Origin, Plan
from ur.launchfile.world.protocol import World
from ur.launchfile.world.system import SystemWorld
from ur.request.environment import apply_selection, current_selection
from ur.request.launch_request import LaunchRequest, make_request
from ur.request.worlds import check_worlds, resolve_worlds
from ur.robot.selection import Selection
from ur.source.arguments import Argument, split_argv, values_of
from ur.source.diagnostic import Diagnostic, Severity, UserError
from ur.source.file import SourceFile, Span

if TYPE_CHECKING:
    from ur.request.bases.base_argument import FileBase

_MAP = "map"
_OTHERS = ("map_file", "world")

Inspect = Callable[[Iterable[Diagnostic]], None]


@dataclass(frozen=True, slots=True)
class LoadedPlan:
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
    given = replace(request, selection=None) if part is not None else request
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
    plan = load_plan(files.paths, texts(arguments), files.world, computers=computers, parsed=files.parsed)
    findings = plan.diagnostics
    if any(node.terminal for node in plan.nodes):
        findings = tuple(map(_harden, findings))
    if any(each.severity is Severity.ERROR for each in findings):
        from ur.request.argument_values import blame_arguments

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
        from ur.request.bases.driver_packages import check_drivers

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
        plan = load_plan(files.paths, texts(complete_arguments(request, local=True)), world, parsed=files.parsed)
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
    return replace(finding, severity=Severity.ERROR)


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
