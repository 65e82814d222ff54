"""The node `map_server`: a map file as the latched topic `map` and the service `static_map`, its zones and walls.

Launch files name the map file in `UR_MAP_FILE`: arguments of a node are split into words, a variable is not.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

import rospy
from nav_msgs.msg import MapMetaData, OccupancyGrid
from nav_msgs.srv import GetMapRequest

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.mapping.wall_server_node import WallServer
from ur_nodes.mapping.zone_server_node import ZoneServer
from ur_nodes.memory_use import return_large_arrays
from ur_nodes.rosio.grid_message import GridResponse, GridService, grid_message, metadata_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.sent import SentMessages
from ur_nodes.rosio.shell import run_node

USAGE = "usage: map_server FILE.yaml\n"


class MapServer:
    """Offers one grid in the frame `~frame_id` (default `map`), and the zones of its file, until it ends."""

    def __init__(self, grid: Grid, file: Path) -> None:
        self._frame = Parameters().text("frame_id", "map")
        self._message = grid_message(grid, self._frame, rospy.Time.now())
        self._service = rospy.Service("static_map", GridService, self._answer)
        self._metadata = rospy.Publisher("map_metadata", MapMetaData, queue_size=1, latch=True)
        sent = SentMessages()
        self._map = rospy.Publisher("map", OccupancyGrid, queue_size=0, latch=True, subscriber_listener=sent)
        sent.publisher = self._map
        self._publish(grid)
        self._zones = ZoneServer(file, grid, self._frame)
        self._walls = WallServer(file, grid, self._replace)

    def _replace(self, grid: Grid) -> None:
        """Offer the map with other walls."""
        self._message = grid_message(grid, self._frame, rospy.Time.now())
        self._publish(grid)

    def _publish(self, grid: Grid) -> None:
        self._metadata.publish(metadata_message(grid, self._message.header.stamp))
        self._map.publish(self._message)

    def _answer(self, _request: GetMapRequest) -> GridResponse:
        return GridResponse(self._message)


def main() -> int:
    """Read the map file of the command line or of `UR_MAP_FILE`, then serve it. Exit code 2 when it cannot be used."""
    arguments = rospy.myargv(sys.argv)[1:] or list(filter(None, [os.environ.get("UR_MAP_FILE")]))
    if arguments and arguments[0] in ("-h", "--help"):
        sys.stdout.write(USAGE)
        return 0
    if len(arguments) != 1:
        found = f"{len(arguments)} arguments" if arguments else "no argument"
        sys.stderr.write(f"error: map_server: {found}, expected one map file\n  {USAGE}")
        return 2
    return_large_arrays()
    try:
        grid = load_map(arguments[0])
    except UserError as problem:
        sys.stderr.write(render_human(problem.diagnostics))
        return 2

    servers: list[MapServer] = []
    return run_node("map_server", lambda: servers.append(MapServer(grid, Path(arguments[0]))))


if __name__ == "__main__":
    sys.exit(main())
