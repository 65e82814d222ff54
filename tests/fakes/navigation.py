"""A navigator that pursues nothing."""

from ur_nodes.ports.actions import GoalHandle
from ur_nodes.ports.node import Node


class FakeNavigation:
    """Takes goals of `move_base` as a node, and pursues each until it is cancelled or the test ends it."""

    def __init__(self, node: Node) -> None:
        self.node = node
        self.goals: list[GoalHandle] = []
        self.cancelled: list[str] = []
        self.server = node.serve_goals("move_base", self)

    @property
    def newest(self) -> GoalHandle:
        return self.goals[-1]

    def handle_goal(self, handle: GoalHandle) -> None:
        handle.accept()
        self.goals.append(handle)

    def handle_cancel(self, handle: GoalHandle) -> None:
        handle.cancel("cancelled")
        self.cancelled.append(handle.goal.id)
