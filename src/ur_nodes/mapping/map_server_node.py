"""The node `map_server`: a map file as the latched topic `map` and the service `static_map`, its zones and walls.

Launch files name the map file in `UR_MAP_FILE`: arguments of a node are split into words, a variable is not.
"""

import os
import sys
from pathlib import Path

from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur_nodes.geometry.grid import load_map
from ur_nodes.mapping.map_server import MapServer
from ur_nodes.memory_use import return_large_arrays
from ur_nodes.run import own_arguments, run

USAGE = "usage: map_server FILE.yaml\n"


def main() -> int:
    """Read the map file of the command line or of `UR_MAP_FILE`, then serve it. Exit code 2 when it cannot be used."""
    arguments = own_arguments(sys.argv[1:]) or list(filter(None, [os.environ.get("UR_MAP_FILE")]))
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
    return run("map_server", lambda node: MapServer(node, grid, Path(arguments[0])))


if __name__ == "__main__":
    sys.exit(main())
