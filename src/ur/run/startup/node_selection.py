"""Selection of the nodes of a plan that run, and refusal of plans that cannot run, before anything starts."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from pathlib import PurePath

from ur.launchfile.plan.specs import MachineSpec, NodeSpec, Plan
from ur.launchfile.world import World
from ur.run.options import RunOptions
from ur.run.paths import is_local_address
from ur.run.process.command import describe_install
from ur.source.data_classes import dataclass, replace
from ur.source.diagnostic import Diagnostic, error, user_error

VIEWERS = ("rviz", "image_view")  # packages whose nodes need a display
# Executables that command a robot: this project's, and the upstream ones that they replace.
COMMANDERS = frozenset(
    {"joy_node", "keyboard_navigate_node", "teleop_node", "teleop_twist_joy", "teleop_twist_keyboard.py"}
)


def may_drive(nodes: Iterable[NodeSpec]) -> bool:
    """Return whether one of these nodes sends velocity commands to a robot."""
    return any(node.type in COMMANDERS for node in nodes)


def has_display(environment: Mapping[str, str]) -> bool:
    """Return whether programs can open windows: X11 or Wayland."""
    return bool(environment.get("DISPLAY") or environment.get("WAYLAND_DISPLAY"))


def is_view(files: Sequence[str]) -> bool:
    """Return whether one of these launch files belongs to a directory `rviz_*`."""
    return any(map(_view_name, files))


def check_display(files: Sequence[str], nodes: Iterable[NodeSpec], environment: Mapping[str, str]) -> None:
    """Raise UserError if a launch file of a directory `rviz_*` is started without a display.

    Other files run without their windows (`leave_out_viewers`); these consist of windows only.
    """
    views = [name for name in map(_view_name, files) if name]
    viewers = [node for node in nodes if node.package in VIEWERS]
    if not views or not viewers or has_display(environment):
        return
    message = f"{views[0]!r} opens a window of RViz and there is no display (DISPLAY is not set)"
    help_ = "run it in a terminal of the desktop, or log in with 'ssh -X'; 'ur run keyboard_navigate' needs no display"
    raise user_error(message, rule="no-display", help=help_)


def leave_out_viewers(
    nodes: tuple[NodeSpec, ...], world: World, environment: Mapping[str, str]
) -> tuple[tuple[NodeSpec, ...], tuple[str, ...]]:
    """Return the nodes that can be displayed on this computer, and one line for each reason why others are left out."""
    viewers = [node for node in nodes if node.package in VIEWERS]
    if viewers and not has_display(environment):
        left_out, notes = viewers, [f"no display: {_names(viewers)} left out"]
    else:
        left_out = [node for node in viewers if not _is_installed(node, world)]
        notes = [
            f"package {package} is not installed: {_names(nodes_of)} left out ({describe_install(package)})"
            for package in VIEWERS
            if (nodes_of := [node for node in left_out if node.package == package])
        ]
    return tuple(node for node in nodes if node not in left_out), tuple(notes)


def force_options(node: NodeSpec, options: RunOptions) -> NodeSpec:
    """Return a node with the options for all nodes applied."""
    if options.force_screen:
        node = node._replace(output="screen")
    if options.force_log:
        node = node._replace(output="log")
    return node._replace(required=True) if options.force_required and not node.respawn else node


def find_remote(plan: Plan, nodes: Sequence[NodeSpec]) -> list[Diagnostic]:
    """Return an error for each node that belongs to another computer."""
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
    """Return an error for each node that cannot have the terminal it needs: one node may, in a run with a terminal."""
    wanting = [node for node in nodes if node.terminal]
    if detached:
        return [
            error(
                f"{node.full_name} needs the terminal, which a detached run does not have",
                rule="detached-terminal",
                help="--no-terminal leaves it out; or start it without --detach",
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


def _view_name(path: str) -> str:
    """Return the directory `rviz_*` that a launch file belongs to; '' for other files."""
    folders = PurePath(path).parts[-3:-1]
    return folders[0] if len(folders) == 2 and folders[0].startswith("rviz_") and folders[1] == "launch" else ""


def _names(nodes: Sequence[NodeSpec]) -> str:
    return ", ".join(node.full_name for node in nodes)


def _is_installed(node: NodeSpec, world: World) -> bool:
    try:
        return bool(world.find_executables(node.package, node.type))
    except LookupError:
        return False


@dataclass(frozen=True, slots=True)
class Away:
    """Another computer and the nodes of a plan that run on it."""

    machine: MachineSpec
    nodes: tuple[NodeSpec, ...]


def split_plan(plan: Plan, is_here: Callable[[str], bool]) -> tuple[Plan, tuple[Away, ...]]:
    """Return the plan with the nodes of this computer only, and those of each other computer, in the plan's order.

    `is_here` tests an address for this computer. Machines with the same address, port and user are one computer.
    Parameters stay in the plan, since there is only one master. A node whose machine is not defined stays too.
    """
    machines = {machine.name: machine for machine in plan.machines}
    known: dict[str, bool] = {}
    here: list[NodeSpec] = []
    away: dict[tuple[str, int, str | None], Away] = {}
    for node in plan.nodes:
        machine = machines.get(node.machine or "")
        if machine is None or known.setdefault(machine.address, is_here(machine.address)):
            here.append(node)
            continue
        key = (machine.address, machine.ssh_port, machine.user)
        before = away.get(key, Away(machine, ()))
        away[key] = replace(before, nodes=(*before.nodes, node))
    return plan._replace(nodes=tuple(here)), tuple(away.values())


def keep_nodes(plan: Plan, names: Collection[str]) -> Plan:
    """Return the plan with these nodes only (full names), for a computer whose nodes share a master with others.

    It neither sets private parameters of the other nodes nor clears a namespace that contains one of them.
    """
    nodes = tuple(node for node in plan.nodes if node.full_name in names)
    others = [node.full_name + "/" for node in plan.nodes if node.full_name not in names]
    return plan._replace(
        nodes=nodes,
        params=tuple(each for each in plan.params if not any(each.name.startswith(other) for other in others)),
        clear_params=tuple(
            space
            for space in plan.clear_params
            if not any(other.startswith(space.rstrip("/") + "/") for other in others)
        ),
    )
