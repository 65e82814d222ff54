"""The node `map_saver`: the map on the topic `map` as a file.

Launch files name the file in `UR_MAP_NAME`: arguments of a node are split into words, a variable is not.
"""

import argparse
import os
import sys
from pathlib import Path

from ur_nodes.mapping.map_saver import MapSaver
from ur_nodes.run import own_arguments, run


def main() -> int:
    """Read the command line, save one map. Exit code 2 when the command line is wrong, 1 when nothing was saved."""
    parser = argparse.ArgumentParser(prog="map_saver", description="Save the map on the topic `map` to a file.")
    name = Path(os.environ.get("UR_MAP_NAME") or "map")
    parser.add_argument("-f", dest="name", type=Path, default=name, help="NAME of NAME.pgm and NAME.yaml")
    parser.add_argument("--occ", type=int, default=65, help="per cent from which on a cell is occupied (default 65)")
    parser.add_argument("--free", type=int, default=25, help="per cent up to which a cell is free (default 25)")
    arguments = parser.parse_args(own_arguments(sys.argv[1:]))
    if not 0 <= arguments.free < arguments.occ <= 100:
        parser.error(f"--free {arguments.free} and --occ {arguments.occ}, expected 0 <= free < occ <= 100")
    savers: list[MapSaver] = []
    limits = arguments.occ, arguments.free
    code = run("map_saver", lambda node: savers.append(MapSaver(node, arguments.name, *limits)))
    return code or int(not savers or savers[0].failed)


if __name__ == "__main__":
    sys.exit(main())
