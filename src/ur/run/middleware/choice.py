"""The middleware of a run, chosen by the environment."""

from __future__ import annotations

from collections.abc import Mapping

from ur.launchfile.world import World
from ur.run.middleware.protocol import Middleware
from ur.run.options import RunOptions
from ur.run.output.console import Console


def find_middleware(environment: Mapping[str, str], world: World, options: RunOptions, console: Console) -> Middleware:
    """Find the middleware of a run. Raises UserError if the selected robot has no master, or one cannot start."""
    if environment.get("ROS_VERSION") == "0":
        from ur.run.middleware.one_process import find_process

        return find_process(environment, options)
    if environment.get("ROS_VERSION") == "2":
        from ur.run.middleware.ros2 import find_ros2

        return find_ros2(environment, options)
    from ur.run.middleware.ros1 import find_ros1

    return find_ros1(environment, world, options, console)
