"""Missing programs of nodes. roslaunch detects them when it starts them; `ur` reports them before."""

from collections.abc import Callable, Iterable

from ur.launchfile.plan.specs import NodeSpec, Plan
from ur.launchfile.syntax import Element
from ur.launchfile.world.protocol import PackageNotFound, World
from ur.source.diagnostic import Diagnostic, Note, error
from ur.source.suggest import did_you_mean, get_command


def check_executables(plan: Plan, world: World) -> tuple[Diagnostic, ...]:
    """Return an error for every node and test of this computer whose package or program does not exist.

    Nodes of other computers are not checked: their packages are on those.
    """
    found: dict[tuple[str, str], bool] = {}
    diagnostics = []
    for node in plan.all_nodes():
        if not plan.is_local(node):
            continue
        key = (node.package, node.type)
        if key not in found:
            try:
                found[key] = bool(world.find_executables(node.package, node.type))
            except (PackageNotFound, OSError, ValueError):
                found[key] = False
        if not found[key]:
            diagnostics.append(_explain(node, world))
    return tuple(diagnostics)


def _explain(node: NodeSpec, world: World) -> Diagnostic:
    steps = tuple(Note("included from here", step) for step in reversed(node.origin.includes))
    start = node.origin.span
    element = Element(start.file, start.text[1:], {}, start.start)
    try:
        files = world.find_files(node.package, node.type)
    except (PackageNotFound, OSError, ValueError):
        near = did_you_mean(node.package, _names(world.package_names))
        return error(
            f"package '{node.package}' of node {node.full_name} is not found, expected an installed one",
            element.value_span("pkg"),
            rule="unknown-package",
            subject=node.package,
            notes=steps,
            help=f"did you mean {near}?"
            if near
            else f"{get_command(node.package)}, or source its workspace's setup.bash",
        )
    if files:
        help_ = f"make it executable: chmod +x {files[0]}"
    else:
        names = _names(lambda: world.executable_names(node.package))
        near = did_you_mean(node.type, names)
        help_ = (
            f"did you mean {near}?" if near else f"{node.package} has: {', '.join(sorted(names)[:10]) or 'no programs'}"
        )
    return error(
        f"package {node.package} has no executable '{node.type}', expected one for node {node.full_name}",
        element.value_span("type"),
        rule="missing-executable",
        subject=node.type,
        notes=steps,
        help=help_,
    )


def _names(list_names: Callable[[], Iterable[str]]) -> set[str]:
    try:
        return set(list_names())
    except (PackageNotFound, OSError, ValueError):
        return set()
