"""A simulated robot on a bus, in one process and one time: nodes are added to it, and it is driven.

The clock is the bus's: each event of the simulator advances the simulation to it, and stamps are of the same time. The
same seed and the same calls give the same run to the last bit; `lock_step.digest` compares two.
"""

import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

from ur.robot.base import Base, load_base
from ur.robot.base.files import find_base_package
from ur.source.project import launch_library
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2, make_pose3
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import AskMap, Place
from ur_nodes.ports.values import Map, Odometry, Result, Transform, Twist
from ur_nodes.simulator import simulator_node

Value = TypeVar("Value")

WORLDS = launch_library() / "n_simulator" / "worlds"
COMMAND_PERIOD = 0.05  # s: a base stops for a command that is older than 0.08 s
ANSWER_LIMIT = 10.0  # s


class DrivenStage:
    """A bus with a simulator, the fixed frames of its base, its map as a service, and a client that drives and asks.

    `parameters` are those of the simulator, `delay` is that of the bus.
    """

    bus_class: ClassVar[Callable[..., Bus]] = Bus

    def __init__(
        self,
        world: str | Path = "maze",
        *,
        delay: Callable[[str], int | None] | None = None,
        **parameters: Any,
    ) -> None:
        self.bus = type(self).bus_class(delay)
        self.world = Path(world) if Path(world).suffix else WORLDS / f"{world}.yaml"
        own: dict[str, Any] = {"world_file": str(self.world), "publish_clock": False} | parameters
        name = str(own.get("base", "stage"))
        own["package"] = str(find_base_package(launch_library(), name, os.environ))
        self.base: Base = load_base(own["package"], name, str(own.get("variant", "")))
        self.client = self.bus.node("client")
        self._commands: dict[str, Any] = {}
        prefix = "robot_0/" if own.get("robots", 1) != 1 else ""
        self.truths = self.record(f"{prefix}base_pose_ground_truth", Odometry)
        self._mount()
        self.simulator = self.add("simulator", simulator_node.start, **own)
        assert self.bus.run_until(lambda: bool(self.truths), 1.0)

    def add(
        self, name: str, start: Callable[[Node], object], remaps: dict[str, str] | None = None, **parameters: Any
    ) -> MemoryNode:
        """Start a node with parameters of its own."""
        self.bus.load_parameters(f"/{name}", parameters)
        node = self.bus.node(name, remaps)
        start(node)
        return node

    def record(self, topic: str, kind: type[Value], quality: Quality = Quality.LOSSLESS) -> list[Value]:
        """A list to which all values of a topic are added as they arrive."""
        values: list[Value] = []
        self.client.subscribe(topic, kind, values.append, quality)
        return values

    def ask(self, service: str, request: object) -> Result:
        """The answer of a service. Time passes until it is there."""
        answers: list[Result] = []
        self.client.call(service, request, answers.append)
        assert self.bus.run_until(lambda: bool(answers), ANSWER_LIMIT), service
        return answers[0]

    def place(self, x: float, y: float, yaw: float = 0.0, name: str = "robot", frame: str = "map") -> Result:
        """Put the robot or an obstacle somewhere."""
        return self.ask("simulator/place", Place(name, frame, Pose2(x, y, yaw)))

    def drive(self, forward: float, turn: float, seconds: float, topic: str = "cmd_vel") -> None:
        """Send a command at 20 Hz for so long."""
        self.drive_until(lambda: False, forward, turn, seconds, topic)

    def drive_until(
        self, condition: Callable[[], bool], forward: float, turn: float, seconds: float, topic: str = "cmd_vel"
    ) -> bool:
        """Send a command at 20 Hz until a condition is true, at most so long. Return whether it is."""
        if topic not in self._commands:
            self._commands[topic] = self.client.publish(topic, Twist, Quality.COMMAND)
        for _ in range(math.ceil(seconds / COMMAND_PERIOD - 1e-9)):
            self._commands[topic].send(Twist(forward, turn))
            if self.bus.run_until(condition, COMMAND_PERIOD):
                return True
        return False

    @property
    def truth(self) -> Odometry:
        """The robot's true pose in the map, and its velocity, as the simulator sent them last."""
        return self.truths[-1]

    def grid(self) -> Grid:
        """The map of the world."""
        return load_map(self.world)

    def free_places(self, room: float) -> NDArray[np.float64]:
        """The places (n, 2) on a grid of 0.5 m where nothing is within `room` m, in reach of the start or not."""
        grid = self.grid()
        low = np.array(grid.origin[:2])
        high = low + np.array(grid.shape[::-1]) * grid.resolution
        x, y = np.meshgrid(np.arange(low[0], high[0], 0.5), np.arange(low[1], high[1], 0.5))
        places = np.column_stack((x.ravel(), y.ravel()))
        steps = np.arange(-room, room + 1e-9, grid.resolution)
        square = np.stack(np.meshgrid(steps, steps), -1).reshape(-1, 2)
        free: NDArray[np.float64] = places[(grid.values_at(places[:, None] + square, outside=100) == 0).all(axis=1)]
        return free

    def serve_map(self) -> None:
        """Serve the map of the world as `static_map`, and publish it as `map`."""
        server = self.bus.node("map_server")
        value = Map(self.bus.now, "map", self.grid())
        server.serve("static_map", AskMap, lambda _request: Result(success=True, value=value))
        server.publish("map", Map, Quality.LATCHED).send(value)

    def _mount(self) -> None:
        """Send the fixed frames of the base's sensors, as its description does."""
        mounted = [each for each in (self.base.lidar, self.base.imu) if each]
        mounted += [*(self.base.sonars.at if self.base.sonars else ())]  # type: ignore[list-item]
        state = self.bus.node("robot_state_publisher")
        for each in mounted:
            place = getattr(each, "pose", (0.0,) * 6)
            pose = make_pose3(place[:3], _quaternion(*place[3:6]))
            state.transforms.send(Transform(self.bus.now, "base_footprint", each.frame, pose, fixed=True))


def _quaternion(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(angle / 2.0), math.sin(angle / 2.0)) for angle in (roll, pitch, yaw))
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )
