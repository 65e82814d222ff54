"""View of RViz from above that shows a whole map: fit_view MAP_FILE CONFIG prints the fitted configuration's path."""

import os
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from ur.source.diagnostic import UserError
from ur.source.foreign.files import read_text
from ur.source.foreign.yaml_text import load_yaml
from ur_nodes.geometry.grid import Grid, load_map

_DOCKS = (370, 90)  # pixels of the window that the list of displays, the menu and the tools take
_MARGIN = 1.04  # of the map's size
_VIEW = "rviz/TopDownOrtho"


def fit_view(config: Mapping[str, Any], grid: Grid) -> dict[str, Any]:
    """Return RViz's configuration with a view from above that shows the whole grid in its window.

    Other kinds of views are left alone. `config` is not changed.
    """
    manager = dict(config.get("Visualization Manager") or {})
    views = dict(manager.get("Views") or {})
    view = dict(views.get("Current") or {})
    window = config.get("Window Geometry") or {}
    if view.get("Class") != _VIEW:
        return dict(config)
    left, bottom, right, top = grid.bounds
    size = (window.get("Width", 1200) - _DOCKS[0], window.get("Height", 720) - _DOCKS[1])
    scale = min(size[0] / ((right - left) * _MARGIN), size[1] / ((top - bottom) * _MARGIN))
    view["Scale"] = round(max(1.0, scale), 2)
    view["X"], view["Y"] = round((left + right) / 2.0, 3), round((bottom + top) / 2.0, 3)
    views["Current"] = view
    manager["Views"] = views
    return {**config, "Visualization Manager": manager}


def main(arguments: list[str]) -> int:
    """Write the fitted configuration into ROS's folder and print its path. Returns the exit code."""
    if len(arguments) != 2:
        sys.stderr.write("error: fit_view: expected a map file and a configuration of RViz\n")
        return 2
    map_file, config = arguments
    home = Path(os.environ.get("ROS_HOME") or Path.home() / ".ros")
    target = home / "rviz" / Path(config).name
    try:
        fitted = fit_view(load_yaml(read_text(config)) or {}, load_map(map_file))
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(yaml.safe_dump(fitted, sort_keys=False), encoding="utf-8")
    except (UserError, OSError, ValueError, yaml.YAMLError) as problem:
        sys.stderr.write(f"warning: the view of RViz is not fitted to the map: {problem}\n")
        return 1
    sys.stdout.write(f"{target}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
