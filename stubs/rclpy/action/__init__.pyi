from collections.abc import Awaitable, Callable
from enum import Enum
from typing import Any

import genpy
from rclpy.action.server import ServerGoalHandle
from rclpy.callback_groups import CallbackGroup
from rclpy.node import Node
from rclpy.task import Future

class CancelResponse(Enum):
    REJECT = 1
    ACCEPT = 2

class GoalResponse(Enum):
    REJECT = 1
    ACCEPT = 2

class ActionServer:
    def __init__(
        self,
        node: Node,
        action_type: type,
        action_name: str,
        execute_callback: Callable[[ServerGoalHandle], Awaitable[genpy.Message]],
        *,
        callback_group: CallbackGroup | None = ...,
        goal_callback: Callable[[Any], GoalResponse] = ...,
        cancel_callback: Callable[[ServerGoalHandle], CancelResponse] = ...,
        result_timeout: int = ...,
    ) -> None: ...
    def destroy(self) -> None: ...

class ActionClient:
    def __init__(self, node: Node, action_type: type, action_name: str) -> None: ...
    def wait_for_server(self, timeout_sec: float | None = ...) -> bool: ...
    def send_goal_async(self, goal: genpy.Message, feedback_callback: Callable[[Any], None] | None = ...) -> Future: ...
