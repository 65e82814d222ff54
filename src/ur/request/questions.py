"""roslaunch's queries about a launch file, and two more: answered from the plan, without starting anything.

The answers are for the calling shell, as in roslaunch: of the selection they use arguments only.
"""

import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping

from ur.launchfile.load import is_for_ros2
from ur.launchfile.plan.names import join_names
from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.query.explain import dump_params, find_node_file, list_files, list_nodes
from ur.launchfile.world.system import SystemWorld
from ur.request.environment import own_packages
from ur.request.launch_request import LaunchRequest, make_request
from ur.request.plan_files import complete_arguments, find_node, localisation_argument, show_findings, texts
from ur.request.programs import PACKAGE
from ur.robot.selection import Selection
from ur.source.arguments import CommandLine
from ur.source.diagnostic import Severity, UserError
from ur.source.user_folders import list_workspaces

_ANONYMOUS = re.compile(r"\$\(anon ([^)]{0,500})\)")
_MASTER = "http://localhost:11311/"  # rosgraph's default
_MASTER_ARGUMENT = "__master"
_NAMESPACE = "ROS_NAMESPACE"


class _AsWritten(SystemWorld):
    """The computer's world, in which `$(anon name)` stays as written, so that a node can be queried by that name."""

    def make_anonymous(self, prefix: str) -> str:
        return f"$(anon {prefix})"


def answer(line: CommandLine, selection: Selection, query: tuple[str, str | None], shell: Mapping[str, str]) -> int:
    """Print the answer to one query and return the exit code. `shell` is the environment before any selection."""
    name, node = query
    world = make_world(shell, anonymous="$(anon " not in (node or ""))
    request = make_request(line, world, selection)
    if name == "ros-args":
        return _print_arguments(request)
    plan = _load(request)
    if plan is None:
        return 1
    match name:
        case "nodes":
            _print(list_nodes(plan))
        case "files":
            _print(list_files(plan))
        case "find-node":
            _print([find_node_file(plan, resolve_name(node or "", shell))])
        case "dump-params":
            print_parameters(plan)
        case _:
            found = find_node(plan, resolve_name(node or "", shell))
            _print([format_command(found, world, shell, request.values.get(_MASTER_ARGUMENT))])
    return 0


def make_world(shell: Mapping[str, str], *, anonymous: bool) -> SystemWorld:
    """Return the world of a shell, with this project's package and those that `ur get` has built.

    With `anonymous`, `$(anon name)` creates names; else it stays as written.
    """
    environment = dict(shell)
    path = environment.get("ROS_PACKAGE_PATH", "")
    if str(PACKAGE) not in path.split(os.pathsep):
        environment["ROS_PACKAGE_PATH"] = f"{path}{os.pathsep}{PACKAGE}"
    made = own_packages(shell)
    if os.path.isdir(made) and made not in path.split(os.pathsep):  # noqa: PTH112 - as in ur.request.environment
        environment["ROS_PACKAGE_PATH"] += f"{os.pathsep}{made}"
    if workspaces := list_workspaces(shell):
        environment["CMAKE_PREFIX_PATH"] = os.pathsep.join(workspaces)
    kind = SystemWorld if anonymous else _AsWritten
    return kind(environment, standard_input=lambda: sys.stdin.buffer.read())


def print_parameters(plan: Plan) -> None:
    """Print the parameters as YAML; run the programs that print some of them. Raises UserError if one fails."""
    from ur.launchfile.plan.commands import run_command, run_commands

    known = len(plan.diagnostics)
    plan = run_commands(plan, run_command)
    if plan.diagnostics[known:]:
        raise UserError(*plan.diagnostics[known:])
    sys.stdout.write(dump_params(plan))


def format_command(node: NodeSpec, world: SystemWorld, shell: Mapping[str, str], master: str | None = None) -> str:
    """Return the output of `roslaunch --args NODE`: variables in double quotes, then argv, joined by single spaces."""
    from ur.run.process.command import find_program

    program = find_program(name_anonymous(node, SystemWorld(shell).make_anonymous), world, 1)
    changed = changed_variables(node, shell, {"ROS_MASTER_URI": master or shell.get("ROS_MASTER_URI", _MASTER)})
    return " ".join([*(f'{name}="{value}"' for name, value in changed.items() if value is not None), *program.argv])


def changed_variables(
    node: NodeSpec, shell: Mapping[str, str], more: Mapping[str, str] | None = None
) -> dict[str, str | None]:
    """Return the variables of a node that differ from the shell's, in roslaunch's order; None for a removed one."""
    environment: dict[str, str | None] = {**shell, **(more or {})}
    environment.pop(_NAMESPACE, None)
    if node.namespace.rstrip("/"):
        environment[_NAMESPACE] = node.namespace.removesuffix("/")
    environment.update(node.env)
    if _NAMESPACE in shell:
        environment.setdefault(_NAMESPACE, None)
    return {name: value for name, value in environment.items() if value != shell.get(name)}


def name_anonymous(node: NodeSpec, make: Callable[[str], str]) -> NodeSpec:
    """Return the node with a name for each `$(anon ...)` in its name and arguments; equal ones get equal names."""
    made: dict[str, str] = {}

    def name(match: re.Match[str]) -> str:
        return made.setdefault(match[1], make(match[1]))

    return node._replace(name=_ANONYMOUS.sub(name, node.name), args=_ANONYMOUS.sub(name, node.args))


def resolve_name(name: str, shell: Mapping[str, str]) -> str:
    """Return a node's full name from its typed form: in ROS_NAMESPACE, as in roslaunch; `$(anon ...)` stays."""
    if name.startswith("$"):
        return name
    namespace = "/" + shell.get(_NAMESPACE, "").strip("/")
    return join_names("/roslaunch", name[1:]) if name.startswith("~") else join_names(namespace, name)


def _load(request: LaunchRequest) -> Plan | None:
    # None when roslaunch would refuse to answer. It does not check that machines are defined.
    arguments = complete_arguments(request, local=True)
    arguments = (*arguments, *localisation_argument(request, arguments))
    plan = request.files.load(texts(arguments))
    show_findings(plan.diagnostics)
    refused = any(each.severity is Severity.ERROR and each.rule != "unknown-machine" for each in plan.diagnostics)
    return None if refused else plan


def _print_arguments(request: LaunchRequest) -> int:
    from ur.launchfile.query.arguments import format_arguments, read_arguments

    files = request.files
    last = files.paths[-1]
    broken = files.parse(last).diagnostics
    if any(each.severity is Severity.ERROR for each in broken) and not is_for_ros2(
        last, files.world, None, files.parsed
    ):
        raise UserError(*broken)
    # roslaunch shows those of the last file
    found = read_arguments(last, texts(request.arguments), files.world, files.parsed)
    sys.stdout.write(format_arguments(found))
    return 0


def _print(lines: Iterable[str]) -> None:
    sys.stdout.write("".join(f"{line if line.isprintable() else _escape(line)}\n" for line in lines))
    sys.stdout.flush()


def _escape(line: str) -> str:
    from ur.source.printable import printable

    return printable(line)
