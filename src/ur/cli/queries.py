"""roslaunch's questions about a launch file: answered from the plan, nothing is started."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterable, Sequence

from ur.launchfile.plan.model import NodeSpec, Plan
from ur.launchfile.syntax.parse import parse_launch_file
from ur.launchfile.world.protocol import World
from ur.source.diagnostic import Severity, UserError, error
from ur.source.suggest import did_you_mean


def print_nodes(plan: Plan) -> None:
    """The full name of every node and test."""
    _print(node.full_name for node in _nodes(plan))


def print_files(plan: Plan) -> None:
    """Every launch file that is read."""
    _print(plan.files)


def print_file_of(plan: Plan, name: str) -> None:
    """The launch file that defines a node."""
    _print([find_node(plan, name).origin.span.file.path])


def print_command(plan: Plan, name: str, world: World) -> None:
    """The command line that starts a node, with the environment that it needs in front."""
    from ur.run.command import find_program

    program = find_program(find_node(plan, name), world, 1)
    set_ = [f"{key}={shlex.quote(value)}" for key, value in program.changes if value is not None]
    _print([" ".join([*set_, *map(shlex.quote, program.argv)])])


def print_parameters(plan: Plan) -> None:
    """The parameters as YAML; runs the programs that print some of them. Raises UserError when one fails."""
    import yaml

    from ur.launchfile.plan.commands import run_command, run_commands

    plan = run_commands(plan, run_command)
    errors = [found for found in plan.diagnostics if found.severity is Severity.ERROR]
    if errors:
        raise UserError(*errors)
    sys.stdout.write(yaml.safe_dump({param.name: param.value for param in plan.params}) + "\n")


def print_arguments(files: Sequence[str], world: World) -> None:
    """The arguments that launch files declare, with what `doc=` says about them, as roslaunch prints them."""
    required, optional = {}, {}
    for path in files:
        launch = parse_launch_file(path, world.read_bytes(path)).launch
        for element in launch.elements if launch is not None else ():
            if element.name == "arg" and "value" not in element.attributes:
                name = element.attributes.get("name", "")
                text = element.attributes.get("doc") or "undocumented"
                default = element.attributes.get("default")
                if default:
                    optional[name] = f'  {name} (default "{default}"): {text}'
                else:
                    required[name] = f"  {name}: {text}"
    lines = []
    for title, found in (("Required Arguments:", required), ("Optional Arguments:", optional)):
        lines += [title, *(found[name] for name in sorted(found))] if found else []
    _print(lines or ["No arguments."])


def find_node(plan: Plan, name: str) -> NodeSpec:
    """The node with this name, given with or without leading slash. Raises UserError: did you mean."""
    full = name if name.startswith("/") else "/" + name
    nodes = {node.full_name: node for node in _nodes(plan)}
    if full in nodes:
        return nodes[full]
    near = did_you_mean(full, nodes)
    raise UserError(
        error(
            f"node {name!r} is not in this launch file, expected one of {', '.join(nodes) or '(none)'}",
            rule="unknown-node",
            help=f"did you mean {near}?" if near else None,
        )
    )


def _nodes(plan: Plan) -> list[NodeSpec]:
    return [*plan.nodes, *(test.node for test in plan.tests)]


def _print(lines: Iterable[str]) -> None:
    sys.stdout.write("".join(f"{line}\n" for line in lines))
    sys.stdout.flush()
