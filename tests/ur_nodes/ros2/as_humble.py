"""Run the contract of ports on an rclpy without what Humble's lacks: as_humble.py NAME ..., see `ros2_stage`."""

import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import rclpy.node
from rclpy.impl.implementation_singleton import rclpy_implementation

_KNOWN = ("source_timestamp", "received_timestamp")  # of a message


class HumbleCallbacks(rclpy.node.PublisherEventCallbacks):
    """Without `matched`, nor `incompatible_type`."""

    def __init__(
        self,
        *,
        deadline: Callable[..., None] | None = None,
        liveliness: Callable[..., None] | None = None,
        incompatible_qos: Callable[..., None] | None = None,
        use_default_callbacks: bool = True,
    ) -> None:
        given: dict[str, Any] = {"deadline": deadline, "liveliness": liveliness, "incompatible_qos": incompatible_qos}
        super().__init__(use_default_callbacks=use_default_callbacks, **given)


def take_as_humble(take: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function that takes a message, without the number and the publisher of it."""

    def take_message(handle: object, kind: object, raw: bool) -> tuple[Any, Mapping[str, Any]] | None:
        taken = take(handle, kind, raw)
        return taken and (taken[0], {name: taken[1][name] for name in _KNOWN})

    return take_message


if __name__ == "__main__":
    module: Any = rclpy.node
    module.PublisherEventCallbacks = HumbleCallbacks
    compiled: Any = rclpy_implementation
    compiled.Subscription.take_message = take_as_humble(compiled.Subscription.take_message)
    sys.path.insert(0, str(Path(__file__).parents[3]))
    from tests.ur_nodes.ports.ros2_stage import main

    from ur_nodes.ros2 import ends

    assert not ends._REPORTS_MATCHES
    main(sys.argv[1:])
