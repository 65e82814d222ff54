"""The topics of simulated cameras: what raspicam_node publishes."""

from __future__ import annotations

import contextlib
import queue
import threading
import time
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image

from ur.robot.base import Base, Camera
from ur.source.diagnostic import UserError
from ur.worlds.world_file import World
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.publishers import has_subscribers
from ur_nodes.simulator.camera_process import CameraProcess
from ur_nodes.simulator.frame_rate import FrameCount

_TRY_EVERY = 10.0  # s: packages may be installed meanwhile


@dataclass(frozen=True, slots=True)
class _Job:
    stamp: rospy.Time
    state: npt.NDArray[np.float64]
    done: threading.Event


class CameraTopics:
    """Publishers of the cameras of all robots, and the thread that has their pictures drawn.

    Nothing is started or drawn before there is a subscriber. A picture that is due while the last one is still being
    drawn is left out, unless the simulation goes as fast as it can: then it waits (`wait`). When many are left out that
    is logged once. Where nothing can draw, an error in the log explains why, and it is tried again every 10 s: the
    subscribers' own messages repeat it (`ur_nodes.rosio.silence`).
    """

    def __init__(self, world: World, base: Base, camera: Camera, prefixes: list[str], wait: bool, quality: int) -> None:
        self.camera = camera
        self._world, self._base, self._quality = world, base, quality
        self._wait = wait
        self._robots = [_Robot(camera, prefix) for prefix in prefixes]
        self._jobs: queue.Queue[_Job | None] = queue.Queue(maxsize=1)
        self._busy = threading.Event()
        self._ended = False
        self._try_at = 0.0
        self._count = FrameCount(camera.rate)
        self._thread = threading.Thread(target=self._run, name="camera", daemon=True)
        self._thread.start()

    @property
    def wanted(self) -> bool:
        """Return whether pictures are to be drawn: there is a subscriber, and the last failure is a while ago."""
        return not self._ended and time.monotonic() >= self._try_at and any(robot.wanted for robot in self._robots)

    def offer(self, stamp: rospy.Time, state: npt.NDArray[np.float64]) -> None:
        """A moment at which a picture is due; called between ticks."""
        busy = self._busy.is_set()
        if short := self._count.note(stamp.to_sec(), made=not busy):
            rospy.logwarn("%s", short)
        if busy:
            return
        self._busy.set()
        job = _Job(stamp, state, threading.Event())
        self._jobs.put(job)
        if self._wait:
            job.done.wait()

    def close(self) -> None:
        """Stop drawing."""
        with contextlib.suppress(queue.Full):
            self._jobs.put_nowait(None)
        self._thread.join(timeout=3.0)

    def _run(self) -> None:
        process: CameraProcess | None = None
        try:
            while (job := self._jobs.get()) is not None:
                try:
                    process = self._draw(process, job)
                finally:
                    self._busy.clear()
                    job.done.set()
        except rospy.ROSException:
            self._ended = True  # topics were closed meanwhile: the node is ending
        finally:
            if process:
                process.close()

    def _draw(self, process: CameraProcess | None, job: _Job) -> CameraProcess | None:
        """Publish the pictures of a moment; returns the process for the next ones, None where this one cannot draw."""
        try:
            process = process or self._open()
            self._publish(process, job)
        except UserError as problem:
            self._try_at = time.monotonic() + _TRY_EVERY
            if process:
                process.close()
            rospy.logerr("%s", "; ".join([str(problem), *(each.help for each in problem.diagnostics if each.help)]))
            return None
        return process

    def _open(self) -> CameraProcess:
        process = CameraProcess(self._world, self._base, self.camera, len(self._robots), quality=self._quality)
        if process.warning:
            rospy.logwarn("%s", process.warning)
        return process

    def _publish(self, process: CameraProcess, job: _Job) -> None:
        for number, robot in enumerate(self._robots):
            if robot.wanted:
                picture = process.take(number, job.state, pixels=robot.wants_pixels, jpeg=robot.wants_jpeg)
                robot.publish(job.stamp, picture.pixels, picture.jpeg)


class _Robot:
    def __init__(self, camera: Camera, prefix: str) -> None:
        name, frame = f"{prefix}{camera.name}", f"{prefix}{camera.frame}"
        self._raw: Any = rospy.Publisher(f"{name}/image_raw", Image, queue_size=1)
        self._compressed: Any = rospy.Publisher(f"{name}/image/compressed", CompressedImage, queue_size=1)
        self._info: Any = rospy.Publisher(f"{name}/camera_info", CameraInfo, queue_size=1)
        self._image = Image(
            width=camera.width, height=camera.height, step=3 * camera.width, encoding="rgb8", is_bigendian=0
        )
        self._jpeg = CompressedImage(format="jpeg")
        self._calibration = camera_info(camera)
        for message in (self._image, self._jpeg, self._calibration):
            message.header.frame_id = frame

    @property
    def wants_pixels(self) -> bool:
        return has_subscribers(self._raw)

    @property
    def wants_jpeg(self) -> bool:
        return has_subscribers(self._compressed)

    @property
    def wanted(self) -> bool:
        return self.wants_pixels or self.wants_jpeg or has_subscribers(self._info)

    def publish(self, stamp: rospy.Time, pixels: bytes, jpeg: bytes) -> None:
        self._calibration.header.stamp = self._image.header.stamp = self._jpeg.header.stamp = stamp
        self._info.publish(self._calibration)
        if pixels:
            self._image.data = pixels
            self._raw.publish(self._image)
        if jpeg:
            self._jpeg.data = jpeg
            self._compressed.publish(self._jpeg)


def camera_info(camera: Camera) -> CameraInfo:
    """The calibration of a camera without distortion; the centre of the first pixel is (0, 0), as in OpenCV."""
    f, cx, cy = camera.focal_length, (camera.width - 1) / 2.0, (camera.height - 1) / 2.0
    return CameraInfo(
        width=camera.width,
        height=camera.height,
        distortion_model="plumb_bob",
        D=[0.0] * 5,
        K=[f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0],
        R=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        P=[f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )


def read_camera(own: Parameters, camera: Camera) -> Camera:
    """The base's camera with the size and rate that parameters ask for; 0 means the base's own."""
    width, height = own.integer("camera_width", 0, minimum=0), own.integer("camera_height", 0, minimum=0)
    rate = own.number("camera_rate", 0.0, minimum=0.0, maximum=200.0)
    return replace(camera, width=width or camera.width, height=height or camera.height, rate=rate or camera.rate)
