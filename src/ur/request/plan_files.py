"""From the words of a command line to a plan, its findings shown."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ur.launchfile.address import resolve_addresses
from ur.launchfile.plan.load import load_plan
from ur.launchfile.plan.model import MachineSpec, Origin, Plan
from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.world.protocol import World
from ur.launchfile.world.system import SystemWorld
from ur.request.worlds import check_worlds, resolve_worlds
from ur.robot.selection import Selection
from ur.source.diagnostic import Diagnostic, Severity, UserError, error
from ur.source.file import SourceFile, Span
from ur.source.suggest import did_you_mean


@dataclass(frozen=True, slots=True)
class Loaded:
    """What a command line means. `plan` is None when it has errors; `files` and `arguments` are what it was made of.

    `robot` is the machine whose nodes belong to the selected robot, which is another computer; '' where there is none.
    `findings` have been shown.
    """

    plan: Plan | None
    world: World
    files: tuple[str, ...] = ()
    arguments: tuple[str, ...] = ()
    robot: str = ""
    findings: tuple[Diagnostic, ...] = ()


@dataclass(frozen=True, slots=True)
class FileWords:
    """The launch files that a command line names, the arguments they declare, and those that they are given."""

    files: tuple[str, ...]
    declared: tuple[str, ...]
    given: tuple[str, ...]
    arguments: tuple[str, ...]


def read_file_words(words: Sequence[str], world: World, selection: Selection | None, *, here: bool) -> FileWords:
    """Read `FILE` or `PACKAGE FILE`, and `[ARG:=VALUE]...`: the form of every verb that takes launch files.

    The selection gives what the files declare and the words do not, and paths of worlds become absolute; without a
    selection the words are complete. `here`: this computer is the robot. Raises UserError: no such file, a word that
    is neither a file nor an argument, a world that cannot be used there.
    """
    files = resolve_addresses(words, world)
    given = [word for word in words if ":=" in word]
    declared = declared_arguments(files, world)
    refuse_stray_words(files, declared, world)
    if selection is None:
        return FileWords(tuple(files), declared, tuple(given), tuple(given))
    away = not here and "robot_machine" in declared and not any(word.startswith("robot_machine:=") for word in given)
    given = resolve_worlds(given, files, declared, selection.robot if away else "")
    selected = selected_arguments(selection, declared, given, here=here)
    return FileWords(tuple(files), declared, tuple(given), (*given, *selected))


def load_words(words: Sequence[str], selection: Selection, part: str | None = None) -> Loaded:
    """What `[PACKAGE] FILE [ARG:=VALUE]...` means; errors in it are then on standard error.

    Arguments about the robot that the file declares and nobody gave come from the selection; not so with `part`: then
    the words are complete, and `part` is a machine that the file need not define: this computer.
    Raises UserError: no such file, a word that is neither a file nor an argument, a base that is not known or lacks
    what the file needs, a driver whose package is not installed.
    """
    world = SystemWorld(os.environ, standard_input=lambda: sys.stdin.buffer.read())
    here = part is not None or selection.simulated or is_this_computer(selection.robot)
    read = read_file_words(words, world, None if part is not None else selection, here=here)
    files, declared = read.files, read.declared
    arguments = list(read.arguments)
    there = not here and f"robot_machine:={selection.robot}" in arguments
    values = dict(word.split(":=", 1) for word in arguments)
    if "robot_base" in values and "robot_base" in declared:
        from ur.request.base_argument import check_base  # reads YAML, which most launch files do without

        check_base(files, values, world)
    arguments = [*arguments, *localisation_argument(files, declared, arguments)]
    computers = [describe_computer(selection.robot, f"{selection.robot}.local")] if there else []
    computers += [describe_computer(part, "localhost")] if part is not None else []
    plan = load_plan(files, arguments, world, computers=computers)
    findings = plan.diagnostics
    if any(node.terminal for node in plan.nodes):
        findings = tuple(map(_harden, findings))
    if findings:
        from ur.source.render import render_human, shows_colour

        sys.stderr.write(render_human(findings, colour=shows_colour(sys.stderr)))
        sys.stderr.flush()
    if values.get("simulate") == "false" and "robot_base" in declared and not there:
        from ur.request.driver_packages import check_drivers

        check_drivers(files, values, plan.nodes, world)
    good = not any(each.severity is Severity.ERROR for each in findings)
    if good:
        check_worlds(plan)
    robot = selection.robot if there else ""
    return Loaded(plan if good else None, world, files, tuple(arguments), robot, findings)


def describe_computer(name: str, address: str) -> MachineSpec:
    """A machine that no launch file has to define."""
    origin = Origin(Span(SourceFile("<selection>", name), 0, len(name)))
    return MachineSpec(name, address, user=None, env_loader=None, ssh_port=22, timeout=10.0, origin=origin)


def declared_arguments(files: Sequence[str], world: World) -> tuple[str, ...]:
    """The arguments that launch files declare and that can be given, in order. Empty for what cannot be read."""
    names: dict[str, None] = {}
    for path in files:
        try:
            parsed = parse_launch_file(path, world.read_bytes(path))
        except OSError:
            continue
        for element in parsed.launch.elements if parsed.launch is not None else ():
            if element.name == "arg" and "value" not in element.attributes:
                names[element.attributes.get("name", "")] = None
    return tuple(names)


def refuse_stray_words(files: Sequence[str], declared: Sequence[str], world: World) -> None:
    """Raise UserError for a word after the launch file that is neither another file nor NAME:=VALUE."""
    for word in files[1:]:
        if word == "-" or world.is_file(word):
            continue
        bare = word.lstrip("-").partition("=")[0]
        near = did_you_mean(bare.replace("-", "_"), declared)
        known = f", expected NAME:=VALUE with NAME one of {', '.join(declared)}"
        if not declared:
            known = ": the launch file declares no arguments"
        raise UserError(
            error(
                f"{word!r} is no argument{known}",
                rule="bad-argument",
                help=f"did you mean {near}:=...?" if near else None if declared else f"leave {word} out",
            )
        )


def selected_arguments(selection: Selection, declared: Sequence[str], given: Sequence[str], *, here: bool) -> list[str]:
    """What the selection says about arguments that are declared and not given. `here`: this computer is the robot.

    A robot that is another computer is a machine of its name.
    """
    taken = {word.partition(":=")[0] for word in given}
    values = {
        "robot_base": selection.base,
        # A variant belongs to its base: with another base given by hand it means nothing.
        "robot_variant": "" if "robot_base" in taken else selection.variant,
        "robot_machine": "localhost" if here else selection.robot,
        "viewer_machine": "localhost",
        "simulate": "" if selection.simulated else "false",
    }
    return [f"{name}:={value}" for name, value in values.items() if value and name in declared and name not in taken]


def localisation_argument(files: Sequence[str], declared: Sequence[str], arguments: Sequence[str]) -> list[str]:
    """As choose_localisation, for arguments written NAME:=VALUE. Raises UserError likewise."""
    if "localisation" not in declared:
        return []
    from ur.request.localisation import choose_localisation  # reads YAML

    return choose_localisation(files, declared, dict(word.split(":=", 1) for word in arguments), os.environ)


def is_this_computer(robot: str) -> bool:
    """Whether a robot's name is the name of the computer we run on."""
    return socket.gethostname().split(".")[0].lower() == robot.lower()


def _harden(finding: Diagnostic) -> Diagnostic:
    # A program takes the screen: a mere warning about a misspelt argument would never be read.
    if finding.rule not in ("unknown-argument", "bad-argument"):
        return finding
    return replace(finding, severity=Severity.ERROR)
