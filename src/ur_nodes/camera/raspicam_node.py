"""Publishes the pictures of a real camera: the node raspicam_node, with its topics, parameters and services."""

from __future__ import annotations

import os
import re
import sys
import threading
from dataclasses import replace
from pathlib import Path
from typing import Any

import rospkg
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from sensor_msgs.srv import SetCameraInfo, SetCameraInfoResponse
from std_srvs.srv import Empty, EmptyResponse

from ur.source.crash import describe_crash, write_crash_report
from ur.source.diagnostic import UserError, error
from ur_nodes.camera.calibration_file import (
    Calibration,
    default_path,
    read_calibration,
    resolve_url,
    write_calibration,
)
from ur_nodes.camera.camera_info_message import make_camera_info, read_camera_info
from ur_nodes.camera.finder import CameraFinder, System
from ur_nodes.camera.formats import decode_jpeg, encode_jpeg
from ur_nodes.camera.loop import CameraLoop
from ur_nodes.camera.model import Adjustments, CameraError, Frame, Mode, PictureSource, Settings
from ur_nodes.pictures.decode import BadPictureError
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.shell import run_node

_NAME = "raspicam_node"


class CalibrationStore:
    """The calibration of a camera, and the file that it is kept in."""

    def __init__(self, url: str, name: str) -> None:
        """Load the file of the URL, else that of the camera's name. Raises UserError where one cannot be read."""
        home = Path(os.environ.get("ROS_HOME") or Path.home() / ".ros")
        self.name = name
        own = resolve_url(url, name, home, find_package)
        stored = default_path(name, home)
        named = own if own and not url.startswith("package://") else None
        # As with camera_info_manager, what was stored for this camera is preferred to what a package holds.
        self.path = named or stored
        places = [each for each in (named, stored, own) if each]
        self.found = next((each for each in places if each.is_file()), None)
        self.calibration = read_calibration(self.found) if self.found else None

    def store(self, calibration: Calibration) -> None:
        """Use and keep a calibration. Raises UserError."""
        write_calibration(self.path, calibration)
        self.calibration, self.found = calibration, self.path


class CameraTopics:
    """Publishes what a camera gives, to whom wants it."""

    def __init__(self, frame: str, quality: int, store: CalibrationStore, finder: CameraFinder) -> None:
        self._compressed: Any = rospy.Publisher("~image/compressed", CompressedImage, queue_size=1, tcp_nodelay=True)
        self._raw: Any = rospy.Publisher("~image", Image, queue_size=1, tcp_nodelay=True)
        self._info: Any = rospy.Publisher("~camera_info", CameraInfo, queue_size=1, tcp_nodelay=True)
        self._frame, self._quality, self._store, self._finder = frame, quality, store, finder
        self._mode: Mode | None = None
        self._message = CameraInfo()

    @property
    def wanted(self) -> bool:
        """See Consumer."""
        return bool(self._compressed.get_num_connections() or self._raw.get_num_connections())

    @quiet_at_end
    def begin(self, mode: Mode) -> None:
        """See Consumer: log which camera it is, and what it gives."""
        self._mode = mode
        rate = f"{mode.rate:g} pictures/s" if mode.rate else "a rate that it does not tell"
        how = "JPEG passed on" if mode.passed_on else f"{mode.format}, encoded as JPEG here"
        name = self._finder.description or mode.camera
        rospy.loginfo("camera: %s: %d x %d, %s, %s", name, mode.width, mode.height, rate, how)
        if mode.missing:
            rospy.logwarn("the camera %s cannot set %s: left as it is", mode.camera, ", ".join(mode.missing))
        self.update_calibration()

    def update_calibration(self) -> None:
        """Publish the calibration of the store from now on, if it is one of pictures of this size."""
        mode, calibration = self._mode, self._store.calibration
        if mode is None:
            return
        if calibration and (calibration.width, calibration.height) != (mode.width, mode.height):
            rospy.logwarn(
                "%s is a calibration of pictures of %d x %d, not %d x %d: it is not used",
                *(self._store.found, calibration.width, calibration.height, mode.width, mode.height),
            )
            calibration = None
        elif calibration is None:
            rospy.loginfo(
                "the camera is not calibrated; ur run calibrate_camera does it, and writes %s", self._store.path
            )
        self._message = make_camera_info(calibration, mode.width, mode.height, self._frame)

    @quiet_at_end
    def take(self, frame: Frame) -> None:
        """See Consumer."""
        stamp = rospy.Time.from_sec(max(0.0, rospy.get_time() - frame.age))
        if self._info.get_num_connections():
            self._message.header.stamp = stamp
            self._info.publish(self._message)
        if not frame.jpeg and frame.pixels is None:
            return
        if self._compressed.get_num_connections():
            picture = frame.jpeg or encode_jpeg(_pixels(frame), self._quality)
            message = CompressedImage(format="jpeg", data=picture)
            message.header.stamp, message.header.frame_id = stamp, self._frame
            self._compressed.publish(message)
        if self._raw.get_num_connections():
            self._publish_raw(frame, stamp)

    @quiet_at_end
    def report(self, problem: CameraError) -> None:
        """See Consumer. `ur_nodes.pictures.silence` repeats it where pictures are missing."""
        rospy.logerr("%s", problem)

    def _publish_raw(self, frame: Frame, stamp: rospy.Time) -> None:
        try:
            pixels = _pixels(frame)
        except BadPictureError as problem:
            rospy.logwarn_throttle(10.0, f"a picture is left out: {problem}")
            return
        height, width = pixels.shape[:2]
        image = Image(height=height, width=width, encoding="rgb8", step=3 * width, data=pixels.tobytes())
        image.header.stamp, image.header.frame_id = stamp, self._frame
        self._raw.publish(image)


class CameraServices:
    """The services `~set_camera_info`, `~stop_capture` and `~start_capture`."""

    def __init__(self, loop: CameraLoop, topics: CameraTopics, store: CalibrationStore) -> None:
        self._loop, self._topics, self._store = loop, topics, store
        rospy.Service("~set_camera_info", SetCameraInfo, self._set_camera_info)
        rospy.Service("~stop_capture", Empty, self._stop)
        rospy.Service("~start_capture", Empty, self._start)

    def _set_camera_info(self, request: Any) -> SetCameraInfoResponse:
        found = read_camera_info(request.camera_info, self._store.name)
        if isinstance(found, str):
            return SetCameraInfoResponse(False, found)
        try:
            self._store.store(found)
        except UserError as problem:
            return SetCameraInfoResponse(False, str(problem))
        self._topics.update_calibration()
        return SetCameraInfoResponse(True, f"written to {self._store.path}")

    def _stop(self, _request: Any) -> EmptyResponse:
        self._loop.pause()
        return EmptyResponse()

    def _start(self, _request: Any) -> EmptyResponse:
        self._loop.resume()
        return EmptyResponse()


def start(system: System | None = None) -> None:
    """Read the parameters, open the camera if it is there, and begin. Raises UserError."""
    own = Parameters()
    settings = read_settings(own)
    store = CalibrationStore(own.text("camera_info_url", ""), read_name(own))
    device = own.text("device", "")
    finder = CameraFinder(settings, device, own.integer("camera_id", 0, minimum=0), system)
    topics = CameraTopics(own.text("camera_frame_id", "raspicam"), settings.quality, store, finder)
    ended = threading.Event()
    loop = CameraLoop(finder.open, topics, ended)
    CameraServices(loop, topics, store)
    first: PictureSource | None = None
    try:
        first = finder.open()
    except CameraError as problem:
        if not problem.waits:
            raise UserError(error(problem.reason, rule="no-camera", help=problem.help or None)) from None
        topics.report(problem)
    thread = threading.Thread(target=run_loop, args=(loop, first), name="camera", daemon=True)

    def end() -> None:
        ended.set()
        loop.wake()
        thread.join(5.0)

    rospy.on_shutdown(end)
    thread.start()


def run_loop(loop: CameraLoop, first: PictureSource | None) -> None:
    """Run the loop in its thread. A defect ends the node with one line that names the file with the traceback."""
    try:
        loop.run(first)
    except Exception as problem:
        report = write_crash_report(problem, _NAME, [Path(rospkg.get_log_dir())])
        rospy.logfatal("%s", describe_crash(problem, _NAME, report))
        rospy.signal_shutdown("a defect of the node")


def read_settings(own: Parameters) -> Settings:
    """The parameters of raspicam_node that cameras of all kinds have. Raises UserError."""
    limits = {"brightness": 0, "contrast": -100, "saturation": -100, "sharpness": -100, "shutter_speed": 0}
    given: dict[str, int] = {}
    for name, least in limits.items():
        if own.has(name):
            most = 10_000_000 if name == "shutter_speed" else 100
            given[name] = round(own.number(name, minimum=least, maximum=most))
    settings = Settings(
        width=own.integer("width", 640, minimum=16),
        height=own.integer("height", 480, minimum=16),
        rate=own.number("framerate", 30.0, minimum=0.1, maximum=1000.0),
        quality=round(own.number("quality", 80, minimum=1, maximum=100)),
        flip_horizontally=own.boolean("hFlip", False),
        flip_vertically=own.boolean("vFlip", False),
    )
    return replace(settings, adjustments=Adjustments(**given))


def read_name(own: Parameters) -> str:
    """The name of the camera, and so of its calibration's file: that of the node unless given. Raises UserError."""
    node = rospy.get_name().strip("/").replace("/", "_")
    name = own.text("camera_name", "") or ("camera" if node == _NAME else node)
    if not re.fullmatch(r"[\w-][\w.-]{0,99}", name):
        own.fail("camera_name", name, "letters, digits, _, - and dots")
    return name


def find_package(name: str) -> str | None:
    """The folder of a package; None where it is not installed."""
    try:
        return str(rospkg.RosPack().get_path(name))
    except rospkg.ResourceNotFound:
        return None


def _pixels(frame: Frame) -> Any:
    return decode_jpeg(frame.jpeg) if frame.pixels is None else frame.pixels


def main(system: System | None = None) -> int:
    """Run the node. Returns the exit code."""
    return run_node(_NAME, lambda: start(system))


if __name__ == "__main__":
    sys.exit(main())
