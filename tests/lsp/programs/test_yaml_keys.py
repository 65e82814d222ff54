"""Completion in YAML files."""

from pathlib import Path

import pytest

from ur.check.worlds import make_world
from ur.complete.yaml_keys import find_parents
from ur.lsp.completion import complete
from ur.lsp.workspace import Workspace

ROOT = Path(__file__).parents[3]


def offer(folder: Path, name: str, text: str) -> list[str]:
    """What is offered at the bar in a text, as it would be inserted."""
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    workspace = Workspace([], lambda paths: make_world(paths, {"ROS_PACKAGE_PATH": str(ROOT)}))
    workspace.set_text(str(path), text.replace("|", ""))
    return [each.insert for each in complete(workspace, str(path), text.index("|"))]


@pytest.mark.parametrize(
    ("text", "parents"),
    [
        ("|", ()),
        ("a: 1\nb|", ()),
        ("a:\n  b: 1\n  |", ("a",)),
        ("a:\n  b:\n    c: 1\n  |", ("a",)),
        ("a:\n  - b: 1\n    |", ("a",)),
        ("a:\n- b: 1\n  c: 2\n- |", ("a",)),
        ("a:\n  x: 1\n  y:\n    - b: 1\n      |", ("a", "y")),
        ("x: {a: 1, b: {c|", ("x", "b")),
        ("a:\n  x: {b: {d: 2}, |", ("a", "x")),
        ("a:\n  - {b|", ("a",)),
    ],
)
def test_parents_are_found_by_indentation_and_braces(text: str, parents: tuple[str, ...]) -> None:
    assert find_parents(text.replace("|", ""), text.index("|"))[0] == parents


def test_base_file_gets_the_keys_of_bases(tmp_path: Path) -> None:
    name = "bases/rover/base.yaml"
    assert "odometry:" in offer(tmp_path, name, "summary: x\n|")
    assert offer(tmp_path, name, "summary: x\nwheels: {rad|") == ["radius: "]
    assert "noise: " in offer(tmp_path, name, "sensors:\n  sonars:\n    topic: x\n    |")
    assert "frame: " in offer(tmp_path, name, "variants:\n  big:\n    sensors:\n      lidar:\n        |")
    assert "lead-acid" in offer(tmp_path, name, "battery: {technology: |")


def test_world_and_map_files_get_their_keys(tmp_path: Path) -> None:
    assert "wall_height: " in offer(tmp_path, "worlds/hall.yaml", "floor_plan: hall.yaml\n|")
    assert "size: " in offer(tmp_path, "worlds/hall.yaml", "floor_plan: x\nboxes:\n  - name: a\n    |")
    assert offer(tmp_path, "maps/hall.yaml", "image: hall.pgm\nocc|") == ["occupied_thresh: "]
    assert offer(tmp_path, "maps/hall.yaml", "image: hall.pgm\nocc|: 3") == ["occupied_thresh"]


def test_parameter_file_gets_the_keys_and_values_of_its_neighbours(tmp_path: Path) -> None:
    (tmp_path / "params").mkdir()
    (tmp_path / "params/one.yaml").write_text("odom_model_type: diff # how it drives\nrates: {slow: 1}\n")
    assert offer(tmp_path, "params/two.yaml", "od|") == ["odom_model_type: "]
    assert offer(tmp_path, "params/two.yaml", "odom_model_type: |") == ["diff"]
    assert offer(tmp_path, "params/two.yaml", "rates:\n  |") == ["slow: "]
    (tmp_path / "params/one.yaml").write_text("[broken: {")
    assert offer(tmp_path, "params/two.yaml", "od|") == []
