from rclpy.impl.implementation_singleton import Handle
from rclpy.node import Context

class GuardCondition:
    handle: Handle
    def __init__(self, callback: None, callback_group: None, context: Context | None = ...) -> None: ...
    def trigger(self) -> None: ...
