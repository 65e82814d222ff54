"""Services that need not be installed: ROS 1 has the one that loads a map, and the other is not offered there."""

import numpy as np
import pytest

from ur_nodes.codecs import find_offered, find_service
from ur_nodes.codecs.dialect import parts_of
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.services import ClearCostmap, LoadMap, MapProblem, Trigger
from ur_nodes.ports.values import Map, Result


def test_request_and_answer_of_a_map_to_load_are_read_as_they_were_written() -> None:
    codec = find_service(LoadMap)
    assert codec.request_of(codec.request(LoadMap("/maps/office.yaml"))) == LoadMap("/maps/office.yaml")
    given = Map(0, "map", Grid(np.array([[0, 100]], np.int8), 0.5, Pose2(1.0, 2.0, 0.0)))
    answer = codec.result_of(codec.response(Result(success=True, value=given)))
    assert isinstance(answer.value, Map)
    assert answer.value.grid.values.tolist() == [[0, 100]]


@pytest.mark.parametrize("problem", MapProblem)
def test_reason_why_a_map_is_not_loaded_has_its_number(problem: MapProblem) -> None:
    codec = find_service(LoadMap)
    answer = codec.result_of(codec.response(Result(False, "no", problem)))
    assert (answer.success, answer.value) == (False, problem)


def test_failure_without_a_reason_is_undefined() -> None:
    codec = find_service(LoadMap)
    assert codec.response(Result(False, "no")).result == 255


def test_path_that_is_too_long_is_refused() -> None:
    codec = find_service(LoadMap)
    request_class, _ = parts_of(codec.service_class)
    with pytest.raises(ValueError, match="text of 5000 characters"):
        codec.request_of(request_class(map_url="x" * 5000))


def test_service_whose_messages_are_missing_is_not_offered() -> None:
    assert find_offered(ClearCostmap) is None


def test_services_that_every_ros_has_are_offered() -> None:
    assert find_offered(Trigger) is find_service(Trigger)
