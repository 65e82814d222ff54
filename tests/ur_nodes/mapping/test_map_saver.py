from pathlib import Path

import numpy as np
import pytest

from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.mapping.map_saver import MapSaver
from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map


class SaverStage:
    """The node, and who makes maps."""

    def __init__(self, name: Path, *, keep: bool = False) -> None:
        self.bus = Bus()
        self.bus.parameters["/map_saver/keep"] = keep
        self.maps = self.bus.node("mapper").publish("map", Map, Quality.LATCHED)
        self.node: MemoryNode = self.bus.node("map_saver")
        self.saver = MapSaver(self.node, name, 65, 25)

    def send(self, *cells: int) -> None:
        self.maps.send(Map(0, "map", Grid(np.array([cells], np.int8), 0.05, Pose2(0.0, 0.0, 0.0))))
        self.bus.run(1.0)


def test_first_map_is_saved_and_the_node_ends(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stage = SaverStage(tmp_path / "flat")
    stage.send(0, 100)
    assert stage.node.ended == "done"
    assert not stage.saver.failed
    assert capsys.readouterr().out == f"saved 2 x 1 cells of 0.05 m as {tmp_path / 'flat.yaml'}\n"
    assert load_map(tmp_path / "flat.yaml").values.tolist() == [[0, 100]]


def test_each_map_is_saved_where_the_node_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stage = SaverStage(tmp_path / "flat", keep=True)
    stage.send(0, 100)
    stage.send(0, 100, -1)
    assert stage.node.ended is None
    assert load_map(tmp_path / "flat.yaml").values.tolist() == [[0, 100, -1]]
    assert capsys.readouterr().out == f"saved 2 x 1 cells of 0.05 m as {tmp_path / 'flat.yaml'}\n"


def test_file_that_cannot_be_written_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    stage = SaverStage(tmp_path / "none" / "flat")
    (tmp_path / "none").write_text("")
    stage.send(0)
    assert stage.saver.failed
    assert f"error: map_saver: '{tmp_path / 'none' / 'flat'}' cannot be written:" in capsys.readouterr().err


def test_map_that_cannot_be_read_ends_the_node_with_the_reason(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    stage = SaverStage(tmp_path / "flat")
    stage.bus.spoil("/map", "map of 2 x 2 cells with 3 values, expected one value per cell")
    stage.bus.run(1.0)
    assert stage.node.ended == "done"
    assert stage.saver.failed
    assert capsys.readouterr().err == "error: map of 2 x 2 cells with 3 values, expected one value per cell\n"


def test_kept_node_saves_the_map_after_one_that_cannot_be_read(tmp_path: Path) -> None:
    stage = SaverStage(tmp_path / "flat", keep=True)
    stage.send(0, 100)
    stage.bus.spoil("/map", "map with resolution 0, expected more than 0 m")
    stage.bus.run(1.0)
    assert stage.saver.failed
    stage.send(0, 100, -1)
    assert not stage.saver.failed
    assert stage.node.ended is None


def test_silence_is_explained(tmp_path: Path) -> None:
    stage = SaverStage(tmp_path / "flat")
    stage.bus.run(16.0)
    assert stage.node.lines == [("warn", "no map on /map for 15 s; is a mapping node running?")]
    assert stage.saver.failed
