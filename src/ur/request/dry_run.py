"""`ur launch --dry-run`: the commands that would be started, as shell lines."""

import json
import shlex
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from ur.launchfile.plan.specs import (
    ACTIVATED,
    LOCAL_ADDRESSES,
    MachineSpec,
    NodeSpec,
    ParameterFile,
    Plan,
    describe_trigger,
)
from ur.launchfile.world.protocol import World
from ur.request.questions import changed_variables
from ur.run.paths import ros_home
from ur.run.process.command import find_program
from ur.run.startup.node_selection import leave_out_viewers
from ur.source.diagnostic import Diagnostic, UserError


def format_dry_run(
    plan: Plan, world: World, shell: Mapping[str, str], argv: Sequence[str]
) -> tuple[list[str], list[Diagnostic]]:
    """Return for each node that would start a comment with its name and machine, and its command line, ready to paste.

    `shell` is the environment of the shell that the lines are for, `world` that of the nodes. The second list has
    errors about missing programs.
    """
    if plan.launcher != "roslaunch":
        return [*_format_by_ros2(plan)], []
    lines = []
    if plan.params:
        lines.append(f"# parameters first: ur launch --dump-params {shlex.join(argv)} | rosparam load -")
    machines = {machine.name: machine for machine in plan.machines}
    problems: list[Diagnostic] = []
    nodes, notes = leave_out_viewers(plan.nodes, world, world.environment)
    lines += [f"# {note}" for note in notes]
    for node in nodes:
        machine = machines.get(node.machine or "")
        try:
            lines += format_node(node, machine, world, shell)
        except UserError as problem:
            problems += problem.diagnostics
            lines.append(f"# {node.full_name}: cannot be started, see the error")
    return lines, problems


def _format_by_ros2(plan: Plan) -> Iterator[str]:
    """Yield comments and command lines of `ros2` that start the same, one node at a time."""
    activated = {each.node for each in plan.actions if each.kind == "state" and each.text == ACTIVATED}
    for node in plan.nodes:
        about = [describe_trigger(node.trigger)] if node.trigger is not None else []
        about += [f"in {node.container}"] if node.container else []
        about += [f"again {node.respawn_delay:g} s after its end"] if node.respawn else []
        about += ["its end ends the launch"] if node.required else []
        about += ["lifecycle node"] if node.kind == "lifecycle" else []
        about += ["then configured and activated"] if node.full_name in activated else []
        yield f"# {', '.join((node.full_name if node.kind != 'program' else node.name, *about))}"
        words = _words_of(node)
        changes: dict[str, str | None] = {**dict.fromkeys(node.unset), **dict(node.env)}
        command = _with_variables(changes, [*shlex.split(node.launch_prefix or ""), *words], {})
        yield f"(cd {shlex.quote(node.cwd)} && {command})" if node.cwd else command
    for gap in plan.gaps:
        where = f" ({gap.origin.span})" if gap.origin is not None else ""
        yield f"# not known: {gap.reason}{where}"


def _words_of(node: NodeSpec) -> list[str]:
    if node.kind == "program":
        return [node.type, *node.words]
    given: list[str] = []
    for source in node.sources:
        if isinstance(source, ParameterFile):
            given += ["--params-file", source.path]
        else:
            values = (("-p", f"{name}:={json.dumps(value, default=str)}") for name, value in source.values)
            given += [word for pair in values for word in pair]
    remaps = [word for source, target in node.remaps for word in ("-r", f"{source}:={target}")]
    namespace = node.namespace.rstrip("/")
    if node.kind == "component":
        names = ["-n", node.name] if node.is_named else []
        names += ["--node-namespace", namespace] if namespace else []
        return ["ros2", "component", "load", node.container, node.package, node.type, *names, *remaps, *given]
    names = ["-r", f"__node:={node.name}"] if node.is_named else []
    names += ["-r", f"__ns:={namespace}"] if namespace else []
    run = ["ros2", "run", node.package, node.type] if node.package else [node.type]
    more = [*names, *remaps, *given]
    return [*run, *node.words, *(["--ros-args", *more] if more else [])]


def format_node(node: NodeSpec, machine: MachineSpec | None, world: World, shell: Mapping[str, str]) -> list[str]:
    """Return a comment and a command line. Raises UserError if the program is not on this computer."""
    if machine is not None and machine.address not in LOCAL_ADDRESSES:
        return [f"# {node.full_name} on {_describe(machine)}", _format_remote(node, machine, world)]
    program = find_program(node, world, 1)
    folder = program.cwd or ros_home(world.environment)
    enter = f"cd {shlex.quote(folder)}"
    if not Path(folder).is_dir():
        enter = f"mkdir -p {shlex.quote(folder)} && {enter}"
    where = f"machine {machine.name!r}, this computer" if machine is not None else "this computer"
    changes = changed_variables(node, shell, world.environment)
    return [f"# {node.full_name} on {where}", f"({enter} && {_with_variables(changes, program.argv, shell)})"]


def _format_remote(node: NodeSpec, machine: MachineSpec, world: World) -> str:
    # The path of the program is known on that computer only: its rosrun finds it.
    remaps = [f"{source}:={target}" for source, target in node.remaps]
    argv = ["rosrun", node.package, node.type, *shlex.split(node.args), *remaps, f"__name:={node.name}"]
    if node.launch_prefix:
        argv[1:1] = ["--prefix", node.launch_prefix]
    master = world.environment.get("ROS_MASTER_URI")
    changes = changed_variables(node, {}, {"ROS_MASTER_URI": master} if master else {})
    command = " ".join(
        filter(None, [machine.env_loader and shlex.quote(machine.env_loader), _with_variables(changes, argv, {})])
    )
    port = ["-p", str(machine.ssh_port)] if machine.ssh_port != 22 else []
    host = f"{machine.user}@{machine.address}" if machine.user else machine.address
    return shlex.join(["ssh", "-t", *port, "--", host, command])


def _with_variables(changes: Mapping[str, str | None], argv: Sequence[str], shell: Mapping[str, str]) -> str:
    if not changes:
        return shlex.join(argv)
    removed = [each for name, value in changes.items() if value is None for each in ("-u", name)]
    set_ = [_set(name, value, shell.get(name)) for name, value in changes.items() if value is not None]
    return " ".join(["env", *removed, *set_, shlex.join(argv)])


def _set(name: str, value: str, known: str | None) -> str:
    # Long lists of folders are shortened by references to the shell's variables.
    front = value.removesuffix(f":{known}")
    if known and front != value:
        return f'{shlex.quote(f"{name}={front}")}:"${name}"'
    return shlex.quote(f"{name}={value}")


def _describe(machine: MachineSpec) -> str:
    user = f"{machine.user}@" if machine.user else ""
    return f"machine {machine.name!r}, {user}{machine.address}"
