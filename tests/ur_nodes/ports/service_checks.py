"""Services, as every backend of `ur_nodes.ports` promises them."""

from functools import partial
from typing import Any

import numpy as np
from tests.ur_nodes.ports.samples import CALIBRATION, GRID, POSES, fields_of
from tests.ur_nodes.ports.stage import STAMP, Stage

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports import values
from ur_nodes.ports.services import AskMap, AskPath, Place, Silent, Switch, Trigger, UseCalibration, UseMap
from ur_nodes.ports.values import Result


def check_service_answers_with_result_and_text(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve("light", Switch, lambda request: Result(request.on, "on" if request.on else "there is no light"))
    stage.begin()
    stage.one.call("light", Switch(on=True), got.append)
    stage.until(lambda: len(got) == 1)
    stage.one.call("light", Switch(on=False), got.append)
    stage.until(lambda: len(got) == 2)
    assert got == [Result(True, "on"), Result(False, "there is no light")]


def check_each_request_arrives_as_it_was_made(stage: Stage) -> None:
    placed = values.StampedPose(STAMP, "map", Pose2(1.0, 2.0, 0.5))
    path = values.Path(STAMP, "map", POSES)
    map_of = values.Map(STAMP, "map", GRID)
    asked: tuple[tuple[object, object], ...] = (
        (Trigger(), None),
        (Silent(), None),
        (AskMap(), map_of),
        (UseMap(map_of, STAMP, "map", Pose2(0.5, 0.25, 0.125), np.arange(9.0).reshape(3, 3)), None),
        (Place("box", "map", Pose2(1.0, 2.0, 0.5)), None),
        (AskPath(placed, placed, 0.25), path),
        (UseCalibration(CALIBRATION), None),
    )
    requests: list[object] = []
    results: list[Result] = []

    def answer(value: object, request: object) -> Result:
        requests.append(request)
        return Result(success=True, value=value)

    for request, value in asked:
        kind: type[Any] = type(request)
        stage.other.serve(f"ask_{kind.__name__}", kind, partial(answer, value))
    stage.begin()
    for number, (request, value) in enumerate(asked, 1):
        stage.one.call(f"ask_{type(request).__name__}", request, results.append)
        stage.until(lambda count=number: len(results) == count)  # type: ignore[misc]  # mypy infers no default
        assert results[-1].success, results[-1].text
        assert fields_of(requests[-1]) == fields_of(request)
        assert fields_of(results[-1].value) == fields_of(value)


def check_failure_of_a_silent_service_reaches_its_client(stage: Stage) -> None:
    got: list[Result] = []
    stage.other.serve("scatter", Silent, lambda _request: Result(False, "there is no map"))
    stage.begin()
    stage.one.call("scatter", Silent(), got.append)
    stage.until(lambda: bool(got))
    if stage.silent_services_hide_failures:
        assert got[0].success
    else:
        assert not got[0].success
        assert "there is no map" in got[0].text


def check_missing_service_is_a_result(stage: Stage) -> None:
    got: list[Result] = []
    stage.begin()
    stage.one.call("nobody/serves_this", Trigger(), got.append, 0.3)
    stage.until(lambda: bool(got))
    assert not got[0].success
    assert "nobody/serves_this" in got[0].text
