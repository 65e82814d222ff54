"""Maps of topics that are saved on request."""

from pathlib import Path

import numpy as np
import pytest

from ur.source.diagnostic import UserError
from ur_nodes.geometry.grid import Grid, load_map
from ur_nodes.geometry.pose import Pose2
from ur_nodes.mapping.save_requests import PATIENCE, SaveRequests, place_of
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import SaveOwnMap, SaveTopicMap
from ur_nodes.ports.values import Map, Result


class SavingStage:
    """A node that saves, a client, and a map on the topic `map`."""

    def __init__(self) -> None:
        self.bus = Bus()
        SaveRequests(self.bus.node("saver"), own="slam_toolbox/save_map")
        self.client = self.bus.node("client")
        self.answers: list[Result] = []

    def publish(self, topic: str = "map") -> None:
        values = np.array([[0, 100, -1], [40, 0, 0]], np.int8)
        given = Map(0, "map", Grid(values, 0.5, Pose2(1.0, 2.0, 0.0)))
        self.client.publish(topic, Map, Quality.LATCHED).send(given)

    def ask(self, request: SaveTopicMap | SaveOwnMap, seconds: float = 0.2) -> list[Result]:
        service = "map_saver/save_map" if isinstance(request, SaveTopicMap) else "slam_toolbox/save_map"
        self.client.call(service, request, self.answers.append, within=60.0)
        self.bus.run(seconds)
        return self.answers


@pytest.fixture
def stage(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SavingStage:
    monkeypatch.setenv("HOME", str(tmp_path))
    return SavingStage()


def test_map_of_a_topic_is_saved_by_the_limits_of_the_request(stage: SavingStage, tmp_path: Path) -> None:
    stage.publish("other_map")
    assert stage.ask(SaveTopicMap(f"{tmp_path}/office", "other_map", occupied=35, free=10)) == [Result(True)]
    read = load_map(tmp_path / "office.yaml")
    assert read.values.tolist() == [[0, 100, -1], [100, 0, 0]]
    assert (read.resolution, read.origin) == (0.5, Pose2(1.0, 2.0, 0.0))


def test_own_map_is_saved_in_the_home_folder_and_replaces_no_file(stage: SavingStage, tmp_path: Path) -> None:
    stage.publish()
    assert stage.ask(SaveOwnMap("office")) == [Result(True)]
    before = (tmp_path / "office.pgm").read_bytes()
    problem = stage.ask(SaveOwnMap("office"))[-1]
    assert not problem.success
    assert problem.text == f"{tmp_path}/office.pgm is there already, and is not replaced"
    assert (tmp_path / "office.pgm").read_bytes() == before


def test_request_without_a_map_fails_after_a_while_and_the_next_one_works(stage: SavingStage) -> None:
    stage.ask(SaveTopicMap("office"), seconds=PATIENCE / 2)
    assert stage.ask(SaveTopicMap("hall"))[-1].text == "another map is being saved"
    stage.bus.run(PATIENCE)
    assert stage.answers[-1].text == f"no map on /map for {PATIENCE:g} s; is a mapping node running?"
    stage.publish()
    assert stage.ask(SaveTopicMap("office"))[-1].success


def test_folder_that_is_not_there_is_named_and_not_made(stage: SavingStage, tmp_path: Path) -> None:
    stage.publish()
    assert stage.ask(SaveTopicMap("halls/office"))[-1].text == f"there is no folder {tmp_path}/halls"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["", "/", "../office", "a/../../b", ".bashrc", "a\nb", "x" * 300, "file://", "maps/"])
def test_name_that_is_no_place_for_a_map_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(UserError, match="expected one as 'office' or '/home/me/office'"):
        place_of(name, tmp_path)


def test_place_is_below_home_or_absolute_and_without_the_ending(tmp_path: Path) -> None:
    assert place_of("office.yaml", tmp_path) == tmp_path / "office"
    assert place_of(f"file://{tmp_path.parent}/office", tmp_path / "home") == tmp_path.parent / "office"
