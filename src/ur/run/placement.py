"""Which nodes of a plan run, and which plans cannot run here: decided before anything is started."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from ur.launchfile.plan.model import NodeSpec, Plan
from ur.launchfile.world import World
from ur.run.debian import describe_install
from ur.run.options import Options
from ur.run.places import is_local_address
from ur.source.diagnostic import Diagnostic, error

VIEWERS = ("rviz", "image_view")  # packages whose nodes need a display


def leave_out_viewers(
    nodes: tuple[NodeSpec, ...], world: World, environment: Mapping[str, str]
) -> tuple[tuple[NodeSpec, ...], tuple[str, ...]]:
    """The nodes that can be shown here, and one line for each reason why others are left out."""
    viewers = [node for node in nodes if node.package in VIEWERS]
    if viewers and not environment.get("DISPLAY") and not environment.get("WAYLAND_DISPLAY"):
        left_out, notes = viewers, [f"no display: {_names(viewers)} left out"]
    else:
        left_out = [node for node in viewers if not _is_installed(node, world)]
        notes = [
            f"package {package} is not installed: {_names(nodes_of)} left out ({describe_install(package)})"
            for package in VIEWERS
            if (nodes_of := [node for node in left_out if node.package == package])
        ]
    return tuple(node for node in nodes if node not in left_out), tuple(notes)


def force_options(node: NodeSpec, options: Options) -> NodeSpec:
    """A node as options for all nodes want it."""
    if options.force_screen:
        node = replace(node, output="screen")
    if options.force_log:
        node = replace(node, output="log")
    return replace(node, required=True) if options.force_required and not node.respawn else node


def find_remote(plan: Plan, nodes: Sequence[NodeSpec]) -> list[Diagnostic]:
    """An error for each node that belongs to another computer."""
    machines = {machine.name: machine for machine in plan.machines}
    local: dict[str, bool] = {}
    problems = []
    for node in nodes:
        machine = machines.get(node.machine or "")
        address = machine.address if machine else (node.machine or "")
        if address not in local:
            local[address] = is_local_address(address)
        if not local[address]:
            problems.append(
                error(
                    f"{node.full_name}: machine {node.machine!r} ({address}) is another computer, expected this one",
                    node.origin.span,
                    rule="remote-machine",
                    help="ur launch starts nodes on this computer only; roslaunch starts them over ssh",
                )
            )
    return problems


def find_terminals(nodes: Sequence[NodeSpec], *, detached: bool) -> list[Diagnostic]:
    """An error for each node that needs the terminal and cannot have it: one may, of a run that has one."""
    wanting = [node for node in nodes if node.terminal]
    if detached:
        return [
            error(
                f"{node.full_name} needs the terminal, which a detached run does not have",
                node.origin.span,
                rule="detached-terminal",
                help="leave --detach out, or this node: --except " + node.full_name,
            )
            for node in wanting
        ]
    return [
        error(
            f"{node.full_name}: {wanting[0].full_name} has the terminal already, expected one such node",
            node.origin.span,
            rule="several-terminals",
        )
        for node in wanting[1:]
    ]


def _names(nodes: Sequence[NodeSpec]) -> str:
    return ", ".join(node.full_name for node in nodes)


def _is_installed(node: NodeSpec, world: World) -> bool:
    try:
        return bool(world.find_executables(node.package, node.type))
    except LookupError:
        return False
