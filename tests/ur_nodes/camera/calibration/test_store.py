import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest
from tests.ur_nodes.camera.calibration.rendered_board import project_views

from ur.source.diagnostic import UserError
from ur_nodes.camera.calibration.board import Board
from ur_nodes.camera.calibration.calibrate_camera_node import CalibrationClient
from ur_nodes.camera.calibration.solve import describe_result, solve_or_fail
from ur_nodes.memory.bus import Bus
from ur_nodes.ports.services import UseCalibration
from ur_nodes.ports.values import Result

RESULT = solve_or_fail(project_views(Board()), Board())
SERVICE = "/left/set_camera_info"


def keep(serve: Callable[[UseCalibration], Result] | None) -> str | None:
    """The answer of a camera's node on a bus, which runs beside the call."""
    bus = Bus()
    store = CalibrationClient(bus.node("calibrate_camera"), "left")
    if serve is not None:
        bus.node("left").serve("left/set_camera_info", UseCalibration, serve)
    with ThreadPoolExecutor(1) as pool:
        answer = pool.submit(store.keep, RESULT.calibration, threading.Event())
        while not answer.done():
            bus.run(0.1)
    return answer.result()


def test_camera_gets_the_calibration_and_its_answer_is_returned() -> None:
    requests: list[UseCalibration] = []

    def answer(request: UseCalibration) -> Result:
        requests.append(request)
        return Result(True, "written to camera.yaml")

    assert keep(answer) == "written to camera.yaml"
    assert requests == [UseCalibration(RESULT.calibration)]
    assert describe_result(RESULT).startswith("reprojection error 0.")


def test_refusal_and_missing_service_are_errors_that_name_it() -> None:
    with pytest.raises(UserError, match=f"not stored: {SERVICE}: the file cannot be written"):
        keep(lambda _request: Result(False, "the file cannot be written"))
    with pytest.raises(UserError, match=f"no service {SERVICE}"):
        keep(None)


def test_wait_ends_with_the_program() -> None:
    ended = threading.Event()
    ended.set()
    assert CalibrationClient(Bus().node("calibrate_camera"), "left").keep(RESULT.calibration, ended) is None
