"""The devices of a simulated robot as those of a booted computer; runs there as root, with the robot's own environment.

Arguments: base, variant, and a file. Each device of the base file appears in /dev, for the group dialout; where the
simulated robot truly is, is in the file: x, y.
"""

import grp
import os
import sys
import time
from pathlib import Path

from ur.robot.base import load_base
from ur.source.project import launch_library
from ur.worlds.world_file import read_world
from ur_nodes.simulator.devices.bench import DeviceBench
from ur_nodes.simulator.simulation import Simulation


def main(base: str, variant: str, place: Path) -> None:
    """Run until the end of the process, in real time."""
    world = read_world(launch_library() / "n_simulator/worlds/maze.yaml")
    simulation = Simulation(world, load_base(launch_library(), base, variant))
    bench = DeviceBench(simulation, Path("/dev"))
    for name in bench.firmwares:
        device = os.path.realpath(name)
        os.chown(device, 0, grp.getgrnam("dialout").gr_gid)
        Path(device).chmod(0o660)
    begun, shown = time.monotonic(), 0.0
    while True:
        simulation.advance()
        bench.step()
        time.sleep(max(0.0, begun + simulation.time - time.monotonic()))
        if simulation.time - shown > 0.2:
            shown = simulation.time
            pose = simulation.pose(0)
            place.with_suffix(".new").write_text(f"{pose[0]} {pose[1]}\n")
            place.with_suffix(".new").replace(place)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2], Path(sys.argv[3]))
