"""Publishes the pictures of a real camera: the node raspicam_node, with its topics, parameters and services."""

import re
import sys
from collections.abc import Callable

from ur.source.diagnostic import UserError, user_error
from ur_nodes.camera.calibration_file import CalibrationStore, find_problem
from ur_nodes.camera.camera_topics import CameraTopics, Shot
from ur_nodes.camera.finder import CameraFinder, FinderSystem
from ur_nodes.camera.loop import CameraLoop
from ur_nodes.camera.source import Adjustments, CameraError, CameraSettings
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.services import Silent, UseCalibration
from ur_nodes.ports.values import Calibration, Result
from ur_nodes.run import run

NAME = "raspicam_node"


def read_settings(own: Parameters) -> CameraSettings:
    """Read the parameters that all kinds of cameras have. Raises UserError."""
    limits = {"brightness": 0, "contrast": -100, "saturation": -100, "sharpness": -100, "shutter_speed": 0}
    given: dict[str, int] = {}
    for name, least in limits.items():
        if own.has(name):
            most = 10_000_000 if name == "shutter_speed" else 100
            given[name] = round(own.number(name, minimum=least, maximum=most))
    return CameraSettings(
        width=own.integer("width", 640, minimum=16),
        height=own.integer("height", 480, minimum=16),
        rate=own.number("framerate", 30.0, minimum=0.1, maximum=1000.0),
        quality=round(own.number("quality", 80, minimum=1, maximum=100)),
        flip_horizontally=own.boolean("hFlip", False),
        flip_vertically=own.boolean("vFlip", False),
        adjustments=Adjustments(**given),
    )


def read_name(node: Node) -> str:
    """Read the name of the camera and its calibration file, by default that of the node. Raises UserError."""
    own, full = node.parameters, node.name.strip("/").replace("/", "_")
    name = own.text("camera_name", "") or ("camera" if full == NAME else full)
    if not re.fullmatch(r"[\w-][\w.-]{0,99}", name):
        own.fail("camera_name", name, "letters, digits, _, - and dots")
    return name


class RaspicamNode:
    """Opens the camera if it is plugged in; offers `~set_camera_info`, `~stop_capture`, `~start_capture`."""

    def __init__(self, node: Node, system: FinderSystem | None = None) -> None:
        """Raises UserError for invalid parameters, or if no camera can appear."""
        own = node.parameters
        settings = read_settings(own)
        self._node = node
        self._store = CalibrationStore(own.text("camera_info_url", ""), read_name(node))
        finder = CameraFinder(settings, own.text("device", ""), own.integer("camera_id", 0, minimum=0), system)
        frame = own.text("camera_frame_id", "raspicam")
        self._topics = CameraTopics(node, frame, settings.quality, self._store, finder)
        self._loop: CameraLoop[Shot] = CameraLoop(node, finder.open, self._topics)
        node.serve_later("~set_camera_info", UseCalibration, self._use_calibration)
        node.serve_later("~stop_capture", Silent, lambda _, give: self._loop.pause(lambda: give(Result(True))))
        node.serve("~start_capture", Silent, self._start)
        try:
            first = finder.open()
        except CameraError as problem:
            if not problem.waits:
                raise user_error(problem.reason, rule="no-camera", help=problem.help or None) from None
            self._loop.begin(problem)
        else:
            self._loop.begin(first)

    def _start(self, _request: Silent) -> Result:
        self._loop.resume()
        return Result(True)

    def _use_calibration(self, request: UseCalibration, give: Callable[[Result], None]) -> None:
        calibration = request.calibration
        if problem := find_problem(calibration):
            give(Result(False, problem))
            return

        def on_request(result: Result) -> None:
            if result.success:
                self._store.use(calibration)
                self._topics.update_calibration()
            give(result)

        self._node.work(lambda: self._write(calibration), on_request, "file")

    def _write(self, calibration: Calibration) -> Result:
        try:
            self._store.write(calibration)
        except UserError as problem:
            return Result(False, str(problem))
        return Result(True, f"written to {self._store.path}")


def main(system: FinderSystem | None = None) -> int:
    """Run the node. Returns the exit code."""
    return run(NAME, lambda node: RaspicamNode(node, system))


if __name__ == "__main__":
    sys.exit(main())
