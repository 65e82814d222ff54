"""The node `map_saver`: the map on the topic `map` as a file.

Launch files name the file in `UR_MAP_NAME`: arguments of a node are split into words, a variable is not.
"""

from __future__ import annotations

import argparse
import os
import sys
import threading
from pathlib import Path

import rospy
from nav_msgs.msg import OccupancyGrid

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.mapping.save import save_map
from ur_nodes.rosio.grid_message import GridMessage, grid_of_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.shell import run_node

PATIENCE = 15.0  # s until the log says that there is no map, and again after as long


class MapSaver:
    """Saves the first map that arrives, then shuts the node down; with `~keep` each one until the end.

    `failed` unless the last one was saved.
    """

    def __init__(self, name: Path, occupied: int, free: int) -> None:
        self._keep = Parameters().boolean("keep", False)
        self._came = self._told = False
        self._name = name
        self._limits = (occupied, free)
        self._saving = threading.Lock()
        self.failed = True
        self._subscriber = rospy.Subscriber("map", GridMessage, self._take, queue_size=1)
        threading.Thread(target=self._explain_silence, name="silence", daemon=True).start()

    def _take(self, message: OccupancyGrid) -> None:
        with self._saving:
            if self._keep or not self._came:
                self._came, self.failed = True, True
                self._save(message)
        if not self._keep:
            rospy.signal_shutdown("done")

    def _save(self, message: OccupancyGrid) -> None:
        try:
            grid = grid_of_message(message)
            file = save_map(self._name, grid, *self._limits)
        except UserError as problem:
            sys.stderr.write(render_human(problem.diagnostics))
        except OSError as problem:
            sys.stderr.write(f"error: map_saver: '{self._name}' cannot be written: {problem.strerror}\n")
        else:
            self.failed = False
            if self._keep and self._told:
                return
            self._told = True
            sys.stdout.write(f"saved {grid.width} x {grid.height} cells of {grid.resolution:g} m as {file}\n")
            sys.stdout.flush()

    def _explain_silence(self) -> None:
        while not rospy.core.is_shutdown_requested():
            threading.Event().wait(PATIENCE)
            if not self._came:
                rospy.logwarn("no map on %s for %g s; is a mapping node running?", rospy.resolve_name("map"), PATIENCE)


def main() -> int:
    """Read the command line, save one map. Exit code 2 when the command line is wrong, 1 when nothing was saved."""
    parser = argparse.ArgumentParser(prog="map_saver", description="Save the map on the topic `map` to a file.")
    name = Path(os.environ.get("UR_MAP_NAME") or "map")
    parser.add_argument("-f", dest="name", type=Path, default=name, help="NAME of NAME.pgm and NAME.yaml")
    parser.add_argument("--occ", type=int, default=65, help="per cent from which on a cell is occupied (default 65)")
    parser.add_argument("--free", type=int, default=25, help="per cent up to which a cell is free (default 25)")
    arguments = parser.parse_args(rospy.myargv(sys.argv)[1:])
    if not 0 <= arguments.free < arguments.occ <= 100:
        parser.error(f"--free {arguments.free} and --occ {arguments.occ}, expected 0 <= free < occ <= 100")
    savers: list[MapSaver] = []

    code = run_node("map_saver", lambda: savers.append(MapSaver(arguments.name, arguments.occ, arguments.free)))
    return code or int(not savers or savers[0].failed)


if __name__ == "__main__":
    sys.exit(main())
