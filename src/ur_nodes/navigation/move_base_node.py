"""The node `move_base`: drives to goals. Stands in for the program of that name in the package `move_base`."""

import sys

from ur_nodes.memory_use import return_large_arrays
from ur_nodes.navigation.goals.goal_watch import read_watch_settings
from ur_nodes.navigation.move_base import MoveBase
from ur_nodes.navigation.move_base_settings import read_settings
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskPath, ClearCostmap, Silent
from ur_nodes.run import run


def start(node: Node) -> None:
    """Accept goals, and step periodically."""
    settings = node.parameters.follow(read_settings, lambda changed: move_base.use(changed))
    move_base = MoveBase(node, settings, read_watch_settings(node.parameters, settings.mux))
    stopped = f"{settings.mux}/stopped"
    node.subscribe(stopped, bool, move_base.on_stop, Quality.LATCHED_EVERY)  # one that ended counts, too
    node.serve_later("~make_plan", AskPath, move_base.make_plan)
    node.serve("~clear_costmaps", Silent, move_base.clear_costmaps)
    for costmap in ("global", "local"):  # both are made of the same obstacles
        service = f"{costmap}_costmap/clear_entirely_{costmap}_costmap"
        node.serve(service, ClearCostmap, move_base.clear_costmaps)
    node.every(settings.navigator.period / settings.repeats, move_base.beat)
    node.on_end(move_base.shut_down)


def main() -> int:
    """Run the node until it ends."""
    return_large_arrays()
    return run("move_base", start)


if __name__ == "__main__":
    sys.exit(main())
