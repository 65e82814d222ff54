"""The first drive in one process: simulator, mux, localisation and navigation, with the parameters of launch files."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.ur_nodes.first_drive.stage import DrivenStage

from ur.launchfile.load import load_plan
from ur.launchfile.plan.specs import Plan
from ur.launchfile.world.system import SystemWorld
from ur.request.environment import add_own_package
from ur.source.project import launch_library
from ur_nodes.geometry.pose import Pose2
from ur_nodes.localisation import amcl_node
from ur_nodes.motion import cmd_vel_mux_node
from ur_nodes.navigation import move_base_node
from ur_nodes.ports.actions import Goal, GoalState
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import PoseEstimate, StampedPose, Twist

STARTS: dict[str, Callable[[Node], object]] = {
    "/cmd_vel_mux": cmd_vel_mux_node.start,
    "/amcl": amcl_node.AmclNode,
    "/move_base": move_base_node.start,
}
"""The nodes of the launch files that run; the stage itself stands for the others."""


def read_launch_files(world: str | Path, base: str = "stage", variant: str = "") -> Plan:
    """The nodes and parameters of `m_robot_base` and `m_move_base` for a base; `world` as `DrivenStage` takes it."""
    library = launch_library()
    system = SystemWorld({**add_own_package(os.environ), "ROS_PACKAGE_PATH": str(library)})
    files = [str(library / f"{name}/launch/{name}.launch.xml") for name in ("m_robot_base", "m_move_base")]
    arguments = [
        f"robot_base:={base}",
        f"robot_variant:={variant}",
        f"map_file:={world if Path(world).suffix else f'{library}/n_map_server/maps/{world}.yaml'}",
    ]
    return load_plan(files, arguments, system)


class FirstDrive(DrivenStage):
    """A stage with mux, amcl and move_base, and a client that sends goals. Begins localised, where the robot is."""

    def __init__(
        self,
        world: str | Path = "maze",
        *,
        base: str = "stage",
        variant: str = "",
        seed: int = 0,
        delay: Callable[[str], int | None] | None = None,
        **parameters: Any,
    ) -> None:
        super().__init__(world=world, base=base, variant=variant, delay=delay, seed=seed, **parameters)
        self.serve_map()
        plan = read_launch_files(world, base, variant)
        values: dict[str, Any] = {each.name: each.value for each in plan.params}
        self.bus.parameters |= {
            name: value for name, value in values.items() if name.startswith(tuple(f"{node}/" for node in STARTS))
        }
        self.states: dict[str, GoalState] = {}
        self._sent = 0
        self._goals = self.client.publish("move_base/goal", Goal, Quality.EVERY)
        self.client.subscribe("move_base/state", GoalState, self._take_state, Quality.EVERY)
        self.estimates = self.record("amcl_pose", PoseEstimate)
        self.commands = self.record("cmd_vel", Twist)
        self._remaps = {spec.full_name: dict(spec.remaps) for spec in plan.nodes if spec.full_name in STARTS}
        for name in self._remaps:
            self.start(name)
        self.bus.run(2.0)

    def start(self, name: str) -> None:
        """Start a node of STARTS; one that runs already ends."""
        self.add(name.lstrip("/"), STARTS[name], self._remaps[name])

    def send_goal(self, x: float, y: float, yaw: float = 0.0) -> str:
        """Send a goal in the map. Returns its id."""
        self._sent += 1
        id = f"goal {self._sent}"
        self._goals.send(Goal(id, StampedPose(self.bus.now, "map", Pose2(x, y, yaw))))
        return id

    def go(self, x: float, y: float, yaw: float = 0.0, seconds: float = 120.0) -> GoalState:
        """Send a goal in the map, and let it end."""
        id = self.send_goal(x, y, yaw)
        assert self.bus.run_until(lambda: self._has_ended(id), seconds), f"{id}: {self.states.get(id)}, {self.truth}"
        return self.states[id]

    def _has_ended(self, id: str) -> bool:
        return id in self.states and self.states[id].state not in ("pending", "active")

    def _take_state(self, state: GoalState) -> None:
        self.states[state.id] = state
