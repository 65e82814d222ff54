"""The state of nodes that stand in for Nav2's, for programs that wait until those are active.

Nodes of this project have no lifecycle: they are active from their start to their end.
`nav2_simple_commander` asks `get_state`, Nav2's panel of RViz 2 the managers' `is_active`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from rclpy.node import Node

if TYPE_CHECKING:
    from lifecycle_msgs.srv import GetState
    from std_srvs.srv import Trigger

STANDS_IN: Final = {
    "amcl": ("amcl",),
    "map_server": ("map_server",),
    "move_base": ("bt_navigator", "controller_server", "planner_server"),
    "slam_gmapping": ("slam_toolbox",),
}
"""Nodes of ours by name, and the managed nodes whose tasks they have."""

MANAGERS: Final = {"amcl": "lifecycle_manager_localization", "move_base": "lifecycle_manager_navigation"}
"""The nodes that manage these."""


def answer_for_managed_nodes(node: Node) -> None:
    """Offer the services of the managed node that this one replaces; nothing for other nodes."""
    name = node.get_name()
    if name in STANDS_IN:
        from lifecycle_msgs.srv import GetState

        for managed in STANDS_IN[name]:
            node.create_service(GetState, f"{managed}/get_state", _answer_state)
    if name in MANAGERS:
        from std_srvs.srv import Trigger

        node.create_service(Trigger, f"{MANAGERS[name]}/is_active", _answer_active)


def _answer_state(_request: GetState.Request, response: GetState.Response) -> GetState.Response:
    from lifecycle_msgs.msg import State

    response.current_state = State(id=State.PRIMARY_STATE_ACTIVE, label="active")
    return response


def _answer_active(_request: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
    response.success = True
    return response
