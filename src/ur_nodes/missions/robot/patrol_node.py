"""The node `patrol`: drives a route of places on the robot, by goals of `move_base` and a lease of its own.

It holds the lease of the mux while the patrol is active, so every program shows who drives, and a take-over pauses it.
"""

import sys

from ur_nodes.missions.robot.patrol_runner import PatrolRunner, PatrolSettings
from ur_nodes.ports.node import Node
from ur_nodes.run import run


def start(node: Node) -> PatrolRunner:
    """Read the parameters and connect. Raises UserError."""
    own = node.parameters
    return PatrolRunner(
        node,
        PatrolSettings(
            mux=own.text("mux", "cmd_vel_mux"),
            navigation=own.text("navigation", "move_base"),
            map_frame=own.text("global_frame", "map"),
            base_frame=own.text("robot_base_frame", "base_footprint"),
            keeper=node.resolve(own.text("waypoints_of", "keyboard_navigate")),
            step_limit=own.number("step_limit", 1800.0, minimum=1.0),
        ),
    )


def main() -> int:
    """Run the node until it ends."""
    return run("patrol", start)


if __name__ == "__main__":
    sys.exit(main())
