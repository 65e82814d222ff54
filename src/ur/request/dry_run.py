"""`ur launch --dry-run`: the commands that would be started, as shell lines."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from pathlib import Path

from ur.launchfile.plan.specs import LOCAL_ADDRESSES, MachineSpec, NodeSpec, Plan
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
