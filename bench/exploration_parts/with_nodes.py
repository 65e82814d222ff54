"""An exploration with all nodes of `make_map` on a bus in one process: no ROS, no real time, the same for a seed."""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from bench.exploration_parts.truth import Truth
from tests.ur_nodes.first_drive.stage import DrivenStage

from ur.launchfile import SystemWorld, load_plan
from ur.source.project import launch_library
from ur_nodes.exploration.explore_node import ExploreNode
from ur_nodes.exploration.status import ExploreStatus, read_status
from ur_nodes.motion import cmd_vel_mux_node
from ur_nodes.navigation import move_base_node
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Map
from ur_nodes.slam.slam_gmapping_node import SlamGmappingNode

_LIMIT = 1800.0  # s of an exploration
_STEP = 0.2  # s between two looks at the robot
_STARTS: dict[str, Callable[[Node], object]] = {
    "/cmd_vel_mux": cmd_vel_mux_node.start,
    "/slam_gmapping": SlamGmappingNode,
    "/move_base": move_base_node.start,
    "/explore": ExploreNode,
}


@dataclass(frozen=True, slots=True, eq=False)
class NodeExploration:
    """The last status, the way in m, the share of the reachable floor that is known, simulated seconds, contacts."""

    status: ExploreStatus
    way: float
    share: float
    seconds: float
    touched: int


def explore_with_nodes(truth: Truth, world: Path, base: str) -> NodeExploration:
    """Explore a world file until the end, for half an hour at most."""
    name, _, variant = base.partition(":")
    stage = DrivenStage(world, base=name, variant=variant)
    library = launch_library()
    system = SystemWorld({**os.environ, "ROS_PACKAGE_PATH": str(library)})
    file = library / "m_make_map" / "launch" / "m_make_map.launch.xml"
    plan = load_plan([str(file)], [f"robot_base:={name}", f"robot_variant:={variant}", "explore:=true"], system)
    values: dict[str, Any] = {each.name: each.value for each in plan.params}
    own = {key: value for key, value in values.items() if key.startswith(tuple(f"{node}/" for node in _STARTS))}
    stage.bus.parameters |= own | {"/slam_gmapping/store": False, "/explore/save_service": ""}
    maps = stage.record("map", Map)
    texts = stage.record("explore/status", str)
    contacts = stage.record("simulator/collisions", int)
    for spec in plan.nodes:
        if spec.full_name in _STARTS:
            stage.add(spec.full_name.lstrip("/"), _STARTS[spec.full_name], dict(spec.remaps))
    status, way, last = ExploreStatus(), 0.0, stage.truth.pose
    while not status.ended and stage.bus.now * 1e-9 < _LIMIT:
        stage.bus.run(_STEP)
        way += math.dist(stage.truth.pose[:2], last[:2])
        last = stage.truth.pose
        status = (read_status(texts[-1]) if texts else None) or status
    grid = maps[-1].grid
    known = grid.values_at(truth.grid.points_of_cells(np.argwhere(truth.floor))) >= 0
    touched = contacts[-1] if contacts else 0
    return NodeExploration(status, way, float(known.mean()), stage.bus.now * 1e-9, touched)
