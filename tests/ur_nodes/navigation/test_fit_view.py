from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.navigation.fit_view import fit_view, main

LIBRARY = Path(__file__).parents[3] / "ubiquity_launches"
CONFIG = LIBRARY / "rviz_navigation" / "rviz" / "navigation.rviz"


def view_of(config: dict[str, Any]) -> dict[str, Any]:
    view: dict[str, Any] = config["Visualization Manager"]["Views"]["Current"]
    return view


@pytest.mark.parametrize("world", ["maze", "office"])
def test_whole_world_is_inside_the_window(world: str) -> None:
    grid = load_map(LIBRARY / "n_map_server" / "maps" / f"{world}.yaml")
    config = yaml.safe_load(CONFIG.read_text())
    view = view_of(fit_view(config, grid))
    assert view["Target Frame"] == "map"
    rows, columns = grid.values.shape
    for cell, centre, origin, pixels in (
        (columns, view["X"], grid.origin.x, config["Window Geometry"]["Width"] - 345),
        (rows, view["Y"], grid.origin.y, config["Window Geometry"]["Height"] - 65),
    ):
        far = max(abs(origin - centre), abs(origin + cell * grid.resolution - centre))
        assert far * view["Scale"] < pixels / 2.0


def test_map_that_is_turned_is_in_the_middle() -> None:
    grid = Grid(np.zeros((10, 30), np.int8), 1.0, Pose2(2.0, 1.0, np.pi / 2.0))
    view = view_of(fit_view(yaml.safe_load(CONFIG.read_text()), grid))
    assert (view["X"], view["Y"]) == (-3.0, 16.0)


def test_other_views_are_left_alone() -> None:
    config = {"Visualization Manager": {"Views": {"Current": {"Class": "rviz/Orbit", "Distance": 3}}}}
    assert fit_view(config, Grid(np.zeros((10, 30), np.int8), 1.0, Pose2(0.0, 0.0, 0.0))) == config


def test_configuration_is_written_to_the_folder_of_ros(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("ROS_HOME", str(tmp_path))
    assert main([str(LIBRARY / "n_map_server" / "maps" / "maze.yaml"), str(CONFIG)]) == 0
    path = Path(capsys.readouterr().out.strip())
    assert path.is_relative_to(tmp_path)
    assert view_of(yaml.safe_load(path.read_text()))["X"] == pytest.approx(9.4)
    assert main(["/no/such/map.yaml", str(CONFIG)]) == 1
    assert "/no/such/map.yaml" in capsys.readouterr().err
