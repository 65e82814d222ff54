"""The nodes that are measured: started by plain roslaunch with a master of their own, ended by process id."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import time
import xmlrpc.client
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import psutil

from ur.robot.base import Base, load_base
from ur.robot.base.search import find_base_package

ROOT = Path(__file__).resolve().parents[2]
MAPS = ROOT / "ubiquity_launches" / "n_map_server" / "maps"
UPSTREAM = {"stage_ros": "stage_ros", "map_server": "map_server", "amcl": "amcl", "move_base": "move_base"}


@dataclass(frozen=True, slots=True)
class Peers:
    """Which upstream packages take the place of ours."""

    stage: bool = False
    map_server: bool = False
    amcl: bool = False
    move_base: bool = False


@dataclass(frozen=True, slots=True)
class Usage:
    """What a node used: CPU seconds and resident memory in MB."""

    cpu: float
    memory: float


def find_upstream() -> tuple[Peers, list[str]]:
    """Which of the upstream packages are installed, and the names of those that are not."""
    import rospkg

    packages = rospkg.RosPack()
    known = set(packages.list())
    missing = [name for name in UPSTREAM if name not in known]
    peers = Peers("stage_ros" in known, "map_server" in known, "amcl" in known, "move_base" in known)
    return peers, missing


def load_robot(name: str) -> Base:
    """`BASE[:VARIANT]`. Raises UserError: there is none."""
    base, _, variant = name.partition(":")
    return load_base(find_base_package(ROOT / "ubiquity_launches", base, os.environ), base, variant)


class Stack:
    """A master and the nodes of one world. A context manager: everything is gone at its end."""

    def __init__(self, world: str, base: Base, directory: Path, speed: float, seed: int, peers: Peers) -> None:
        self._directory = directory
        self.port = _free_port()
        self.simulated_clock = speed != 1.0
        launch = directory / f"{world}.launch"
        launch.write_text(_launch_file(world, base, directory, speed, seed, peers), encoding="utf-8")
        environment = dict(os.environ)
        environment |= {
            "ROS_MASTER_URI": f"http://localhost:{self.port}",
            "ROS_HOSTNAME": "localhost",
            "ROS_LOG_DIR": str(directory / "log"),
            "ROS_HOME": str(directory / "home"),
            "ROS_PACKAGE_PATH": os.pathsep.join(
                filter(None, (str(ROOT / "ubiquity_launches"), os.environ.get("ROS_PACKAGE_PATH", "")))
            ),
        }
        os.environ.update(environment)
        self._log = (directory / f"{world}.log").open("wb")
        self._process = subprocess.Popen(
            ["/usr/bin/roslaunch", "-p", str(self.port), str(launch)],
            env=environment,
            stdout=self._log,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )

    def __enter__(self) -> Stack:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(30)
        except subprocess.TimeoutExpired:
            for child in psutil.Process(self._process.pid).children(recursive=True):
                child.kill()
            self._process.kill()
            self._process.wait(5)
        self._log.close()

    def wait_for(self, what: str, condition: Any, seconds: float = 60.0) -> None:
        """Wait until a condition holds. Raises SystemExit, with the end of the log, when it never does."""
        deadline = time.monotonic() + seconds
        while not condition():
            if self._process.poll() is not None or time.monotonic() > deadline:
                self._log.flush()
                tail = "\n".join(Path(self._log.name).read_text(errors="replace").splitlines()[-15:])
                raise SystemExit(f"error: {what} did not appear within {seconds:.0f} s, expected it sooner\n{tail}")
            time.sleep(0.1)

    def master_answers(self) -> bool:
        """Whether the master is up."""
        try:
            answer: Any = xmlrpc.client.ServerProxy(f"http://localhost:{self.port}").getPid("/bench")
            return bool(answer[0] == 1)
        except OSError:
            return False

    def usage(self) -> dict[str, Usage]:
        """Of each node that roslaunch started, and of the master."""
        found: dict[str, Usage] = {}
        for child in psutil.Process(self._process.pid).children(recursive=True):
            with suppress(psutil.NoSuchProcess):
                name = _node_name(child.cmdline())
                times = child.cpu_times()
                if name:
                    found[name] = Usage(times.user + times.system, child.memory_info().rss / 1e6)
        return found


def _node_name(command: list[str]) -> str:
    names = [word.split(":=", 1)[1] for word in command if word.startswith("__name:=")]
    if names:
        return names[0]
    return "(master)" if any(word.endswith("rosmaster") for word in command) else ""


def _launch_file(world: str, base: Base, directory: Path, speed: float, seed: int, peers: Peers) -> str:
    map_file = MAPS / f"{world}.yaml"
    packages = " ".join(
        f'<arg name="{name}_pkg" value="{name}"/>'
        for name in ("map_server", "amcl", "move_base")
        if getattr(peers, name)
    )
    if peers.stage:
        robot = _stage(world, directory)
    else:
        robot = f"""
  <include file="$(find ubiquity_launches)/m_robot_base/launch/m_robot_base.launch.xml">
    <arg name="robot_base" value="{base.name}"/> <arg name="robot_variant" value="{base.variant}"/>
    <arg name="world" value="{world}"/>
    <arg name="speed" value="{speed}"/> <arg name="seed" value="{seed}"/>
  </include>"""
    return f"""<launch>
  <machine name="localhost" address="localhost"/>{robot}
  <include file="$(find ubiquity_launches)/m_move_base/launch/m_move_base.launch.xml">
    <arg name="robot_base" value="{base.name}"/> <arg name="map_file" value="{map_file}"/> {packages}
  </include>
</launch>
"""


def _stage(world: str, directory: Path) -> str:
    """stage_ros with the same floor plan and a robot of the same size, speed and lidar."""
    from PIL import Image

    from ur_nodes.geometry.grid import load_map

    grid = load_map(str(MAPS / f"{world}.yaml"))
    width, height = grid.width * grid.resolution, grid.height * grid.resolution
    picture = directory / f"{world}.png"
    Image.fromarray(((grid.values[::-1] < 65) * 255).astype("uint8")).save(picture)
    (directory / f"{world}.world").write_text(
        f"""
interval_sim 50
define lidar ranger ( sensor ( range [ 0.12 12.0 ] fov 359 samples 360 noise [0.01 0.0 0.0] ) size [0.05 0.05 0.1] )
model ( name "floor" bitmap "{picture}" boundary 0 gui_move 0 laser_return 1 obstacle_return 1
  size [{width} {height} 1.0] pose [{grid.origin.x + width / 2} {grid.origin.y + height / 2} 0 0] )
position ( name "robot" size [0.4 0.38 0.25] drive "diff" localization "odom" odom_error [0.01 0.01 0.01 0.01]
  velocity_bounds [-0.5 0.5 0 0 0 0 -57.3 57.3] acceleration_bounds [-1 1 0 0 0 0 -172 172]
  pose [0 0 0 0] lidar ( pose [0.1 0 0.1 0] ) )
""",
        encoding="utf-8",
    )
    return f"""
  <node name="simulator" pkg="stage_ros" type="stageros" args="-g {directory / f"{world}.world"}">
    <remap from="base_scan" to="scan"/>
  </node>"""


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("localhost", 0))
        return int(probe.getsockname()[1])
