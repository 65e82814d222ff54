"""The simulator as a node: it loads a world and a base, and runs them."""

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ur.robot.base import Base, load_base
from ur.robot.base.calibration import Calibration, parse_calibration
from ur.source.project import launch_library
from ur.worlds.world_file import MOST_PEOPLE, WorldModel, read_world
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.run import run
from ur_nodes.simulator.camera.camera_topics import SimulatedCameraTopics
from ur_nodes.simulator.operation import Operation
from ur_nodes.simulator.settings import list_prefixes, read_camera, read_settings
from ur_nodes.simulator.simulation import Simulation

if TYPE_CHECKING:
    from ur_nodes.simulator.devices.bench import DeviceBench


def start(node: Node) -> None:
    """Read the parameters, load world and base, and run. Raises UserError."""
    own = node.parameters
    base = load_base(own.text("package", str(launch_library())), own.text("base", "stage"), own.text("variant", ""))
    world = read_world(own.text("world_file", str(launch_library() / "n_simulator/worlds/maze.yaml")))
    settings = read_settings(own, simulated_clock=node.facts.simulated_time)
    simulation = make_simulation(own, world, base)
    if settings.publish_clock and not node.facts.simulated_time:
        node.log.warn("/clock is published but /use_sim_time is not true: other nodes go by another clock")
    camera = None
    if base.raspicam:
        wanted, jpeg_quality = read_camera(own, base.raspicam)
        prefixes = list_prefixes(simulation)
        camera = SimulatedCameraTopics(
            node, world, base, wanted, prefixes, wait=settings.speed == 0.0, quality=jpeg_quality
        )
    Operation(node, simulation, settings, camera, open_devices(own, simulation)).begin()


def open_devices(own: Parameters, simulation: Simulation) -> "DeviceBench | None":
    """The stand-ins of the robot's devices in the folder `~devices`; '': none. Raises UserError."""
    folder = own.text("devices", "")
    if folder and (simulation.robots > 1 or not folder.startswith("/")):
        own.fail("devices", folder, "the path of a folder, and one robot")
    if not folder:
        return None
    from ur_nodes.simulator.devices.bench import DeviceBench  # with the drivers' boards, for robots with devices only

    return DeviceBench(simulation, Path(folder), own.integer("seed", 0, minimum=0))


def make_simulation(own: Parameters, world: WorldModel, base: Base) -> Simulation:
    """The simulation that parameters ask for. Raises UserError: a robot would begin in a wall."""
    x, y, yaw = world.start
    errors = parse_calibration(own.text("errors", ""), "errors")
    base, believed = make_wrong(base, errors, parse_calibration(own.text("calibration", ""), "calibration"))
    people = own.integer("people", -1, minimum=-1)
    if people > MOST_PEOPLE:
        own.fail("people", people, f"a whole number of at most {MOST_PEOPLE}")
    return Simulation(
        world if people < 0 else replace(world, people=people),
        base,
        robots=own.integer("robots", 1, minimum=1),
        seed=own.integer("seed", 0, minimum=0),
        start=(own.number("x", x), own.number("y", y), own.number("yaw", yaw)),
        charge=own.number("battery_charge", 1.0, minimum=0.0, maximum=1.0),
        believed=believed,
    )


def make_wrong(base: Base, errors: Calibration, known: Calibration) -> tuple[Base, Base]:
    """Return the base that a robot has and the one that it is believed to have, for the calibration that it needs.

    That of its base file goes on to be the size of its wheels, so that its body stays as it is.
    """
    x, y, z, roll, pitch, yaw = base.lidar.pose if base.lidar else (0.0,) * 6
    lidar = base.lidar and replace(base.lidar, pose=(x, y, z, roll, pitch, yaw + errors.lidar_yaw))
    believed = Calibration(0.0, 1.0 / errors.wheel_radius, 1.0 / errors.wheel_separation).then(known).apply(base)
    return replace(base, lidar=lidar), believed


def main() -> int:
    """Run the node."""
    return run("simulator", start)


if __name__ == "__main__":
    sys.exit(main())
