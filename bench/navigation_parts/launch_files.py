"""Launch files of the nodes that are measured, for plain roslaunch and `ur launch`."""

from dataclasses import dataclass
from pathlib import Path

from bench.navigation_parts.stack import Peers
from bench.navigation_parts.worlds import BenchWorld

from ur.robot.base import Base


@dataclass(frozen=True, slots=True)
class Simulated:
    """A base in a world; `speed` is simulated seconds in a second, `seed` that of the noise."""

    world: BenchWorld
    base: Base
    speed: float
    seed: int


def navigation_launch(simulated: Simulated, map_file: Path, directory: Path, peers: Peers) -> str:
    """Simulator, map server, localisation and navigation on a map; upstream's nodes where `peers` says so."""
    packages = " ".join(
        f'<arg name="{name}_pkg" value="{name}"/>'
        for name in ("map_server", "amcl", "move_base")
        if getattr(peers, name)
    )
    robot = _stage(simulated.world, directory) if peers.stage else _robot(simulated)
    return f"""<launch>
  <machine name="localhost" address="localhost"/>{robot}
  <include file="$(find ubiquity_launches)/m_move_base/launch/m_move_base.launch.xml">
    <arg name="robot_base" value="{simulated.base.name}"/> <arg name="map_file" value="{map_file}"/> {packages}
  </include>
</launch>
"""


def exploration_launch(simulated: Simulated, name: str) -> str:
    """Simulator and the program that explores; it stores the map under a name and ends."""
    return f"""<launch>
  <machine name="localhost" address="localhost"/>{_robot(simulated)}
  <include file="$(find ubiquity_launches)/m_make_map/launch/m_make_map.launch.xml">
    <arg name="robot_base" value="{simulated.base.name}"/> <arg name="robot_variant" value="{simulated.base.variant}"/>
    <arg name="bring_up" value="false"/> <arg name="explore" value="true"/> <arg name="map" value="{name}"/>
    <arg name="use_rviz" value="false"/>
  </include>
</launch>
"""


def _robot(simulated: Simulated) -> str:
    return f"""
  <include file="$(find ubiquity_launches)/m_robot_base/launch/m_robot_base.launch.xml">
    <arg name="robot_base" value="{simulated.base.name}"/> <arg name="robot_variant" value="{simulated.base.variant}"/>
    <arg name="world" value="{simulated.world.source}"/>
    <arg name="speed" value="{simulated.speed}"/> <arg name="seed" value="{simulated.seed}"/>
  </include>"""


def _stage(world: BenchWorld, directory: Path) -> str:
    """stage_ros with the same floor plan and a robot of the same size, speed and lidar."""
    from PIL import Image

    grid = world.grid
    width, height = grid.width * grid.resolution, grid.height * grid.resolution
    picture = directory / f"{world.name}.png"
    Image.fromarray(((grid.values[::-1] < 65) * 255).astype("uint8")).save(picture)
    (directory / f"{world.name}.world").write_text(
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
  <node name="simulator" pkg="stage_ros" type="stageros" args="-g {directory / f"{world.name}.world"}">
    <remap from="base_scan" to="scan"/>
  </node>"""
