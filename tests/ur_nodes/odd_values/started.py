"""Every node of the project on a bus, as its module starts it, beside a small world that moves."""

import runpy
import socket
import sys
from collections.abc import Callable
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
import yaml
from tests.ur_nodes.odd_values.stranger import SLOWEST, mount_sensors, send_frames

import ur_nodes.run
from ur.source.foreign.yaml_text import load_yaml
from ur.source.project import launch_library
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedTwist, Twist

SRC = Path(__file__).parents[3] / "src"
OTHERS = ("start_node.py", "replay_node.py", "map_saver_node.py", "launch_steps_node.py")
"""A program that starts others, a node that reads a file and no topic, and one that ends with its first map."""

MODULES = sorted(
    ".".join(path.relative_to(SRC).with_suffix("").parts)
    for path in (SRC / "ur_nodes").rglob("*_node.py")
    if path.name not in OTHERS
)
SOURCES = yaml.safe_load((launch_library() / "n_cmd_vel_mux/params/sources.yaml").read_text())
STAGE = load_yaml((launch_library() / "n_move_base/params/stage.yaml").read_text())
DESCRIPTION = """<robot name="odd"><link name="base_footprint"/><link name="wheel"/><joint name="odd" type="continuous">
<parent link="base_footprint"/><child link="wheel"/><axis xyz="0 1 0"/></joint></robot>"""
PARAMETERS: dict[str, dict[str, Any]] = {
    "cmd_vel_mux": {"base": "stage", "obstacle_stop": True, **SOURCES},
    "move_base": STAGE,
    "base_driver": {"base": "create2", "device_folder": "/nonexistent"},
    "driver_adapter": {"base": "create2", "variant": "lidar", "rename_scan": True, "publish_tf": True},
    "gnss_driver": {"device": "/nonexistent"},
    "imu_driver": {"base": "stage", "device": "/nonexistent", "imu": "bno055"},
    "lidar_driver": {"base": "create2", "variant": "lidar", "device_folder": "/nonexistent"},
    "sonar_driver": {"base": "magni", "device": "/nonexistent"},
    "robot_state_publisher": {"robot_description": DESCRIPTION},
    "velocity_smoother": {f"{name}_{axis}": 1.0 for name in ("speed_lim", "accel_lim") for axis in "vw"},
}
"""Of nodes that need some, by the last part of their modules without `_node`."""

ARGUMENTS: dict[str, list[str]] = {
    "republish": ["compressed", "raw"],
    "map_server": [str(launch_library() / "n_map_server/maps/maze.yaml")],
}
SOCKETS = {"robot_endpoint": 2, "data_endpoint": 1, "assistant_endpoint": 1, "viewer_endpoint": 1, "graph_report": 1}


class StartedNode:
    """A node on a bus with the transforms of a robot that turns on the spot."""

    def __init__(self, module: str, patch: pytest.MonkeyPatch) -> None:
        self.bus = Bus()
        self.bus.facts |= {"base_name": "stage", "variant": ""}
        name = name_of(module)
        self.world = self.bus.node("world")
        mount_sensors(self.world)
        self.world.every(0.05, lambda: send_frames(self.world))
        self.bus.load_parameters("/odd", PARAMETERS.get(name, {}))
        self.node: MemoryNode = self.bus.node("odd")
        self.sockets = [socket.socketpair() for _ in range(SOCKETS.get(name, 0))]
        words = [*ARGUMENTS.get(name, []), *(str(mine.detach()) for _, mine in self.sockets)]
        self._watched: set[str] = set()
        self.motions: list[Twist] = []
        self.wired = start_of(module, words, patch)(self.node)

    def topics(self) -> dict[str, Any]:
        """The kinds of the topics that the node subscribes to, as values and not as raw messages."""
        return {
            topic: kind[0] if isinstance(kind := each.kind, tuple) else kind
            for topic, entry in self.bus.topics.items()
            for each in entry.subscribers
            if each.node == self.node.name and each.kind is not object
        }

    def services(self) -> dict[str, type]:
        """The kinds of the node's services."""
        return {name: each.kind for name, each in self.bus.services.items() if each.node == self.node.name}

    def outputs(self) -> dict[str, Any]:
        """The kinds of the topics on which the node publishes velocities."""
        return {
            topic: offer.kind
            for topic, entry in self.bus.topics.items()
            for offer in entry.publishers
            if offer.sender == self.node.name and offer.kind in (Twist, StampedTwist)
        }

    def watch(self) -> None:
        """Note the velocities that the node sends from now on."""
        for topic, kind in self.outputs().items():
            if topic not in self._watched:
                self._watched.add(topic)
                self.world.subscribe(topic, kind, self._note, Quality.EVERY)

    def close(self) -> None:
        """End the node, and its sockets."""
        self.node.end("the test ends")
        for server, _ in self.sockets:
            server.close()

    def _note(self, value: Twist | StampedTwist) -> None:
        twist = value.twist if isinstance(value, StampedTwist) else value
        if any(abs(getattr(twist, each.name)) > SLOWEST for each in fields(twist)):
            self.motions.append(twist)


def name_of(module: str) -> str:
    """The last part of a node's module, without `_node`."""
    return module.rpartition(".")[2].removesuffix("_node")


def start_of(module: str, words: list[str], patch: pytest.MonkeyPatch) -> Callable[[Node], object]:
    """What a node's module gives to `ur_nodes.run` as the function that starts it."""
    got: list[Callable[[Node], object]] = []

    def take(_name: str, start: Callable[[Node], object], *_rest: object, **_options: object) -> int:
        got.append(start)
        return 0

    for name in ("run", "run_foreground"):
        patch.setattr(ur_nodes.run, name, take)
    patch.setattr("ur_nodes.web.server_link.run", take)
    patch.setattr("os.nice", lambda _steps: 0)
    patch.setattr(sys, "argv", [module, *words])
    patch.delitem(sys.modules, module, raising=False)  # else it is run a second time, with a warning
    with pytest.raises(SystemExit):
        runpy.run_module(module, run_name="__main__")
    (start,) = got
    return start
