"""The topics of simulated cameras: what raspicam_node publishes."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from ur.robot.base import Base, Camera
from ur.source.diagnostic import UserError
from ur.worlds.world_file import WorldModel
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Calibration, PackedPicture, Picture
from ur_nodes.simulator.camera.camera_process import CameraProcess
from ur_nodes.simulator.camera.camera_process import RenderedPicture as Drawing

PAUSE = 1.0  # s without a picture that is due
ENOUGH = 0.9  # of the pictures that are due


class FrameCount:
    """Counts due pictures and drawn ones, over windows of time."""

    def __init__(self, rate: float, window: float = 5.0) -> None:
        """`rate` is in pictures a second; the first `window` (s) is left out, as drawing starts then."""
        self._rate = rate
        self._window = window
        self._begin = self._last = -math.inf
        self._due = self._made = 0
        self._warm = False
        self._warned = False

    def note(self, time: float, *, made: bool) -> str | None:
        """Count a picture that is due at a time (s), drawn or left out.

        Returns a warning, once, if too few are drawn.
        """
        if not 0.0 <= time - self._last <= PAUSE:
            self._begin, self._due, self._made = time, 0, 0  # no subscriber for a while, or time was reset
        self._last = time
        self._due += 1
        self._made += made
        passed = time - self._begin
        if passed < self._window:
            return None
        reached, warm = self._rate * self._made / self._due, self._warm  # few are due while subscribers come and go
        self._begin, self._due, self._made, self._warm = time, 0, 0, True
        if self._warned or not warm or reached >= ENOUGH * self._rate:
            return None
        self._warned = True
        return (
            f"the simulated camera makes {reached:.0f} of the {self._rate:.0f} pictures a second asked for:"
            " this computer draws no faster; the others are left out, everything else keeps its pace"
        )


_TRY_EVERY = 10.0  # s: packages may be installed meanwhile


class SimulatedCameraTopics:
    """Publishers of the cameras of all robots; their pictures are drawn on a worker.

    Nothing is started or drawn before there is a subscriber. A picture that is due while the last one is still being
    drawn is left out, unless the simulation goes as fast as it can: then it waits (`wait`). When many are left out that
    is logged once. Where nothing can draw, an error in the log explains why, and it is tried again every 10 s: the
    subscribers' own messages repeat it (`ur_nodes.pictures.feed`).
    """

    def __init__(
        self,
        node: Node,
        world: WorldModel,
        base: Base,
        camera: Camera,
        prefixes: Sequence[str],
        *,
        wait: bool,
        quality: int,
    ) -> None:
        self.camera = camera
        self._node = node
        self._world, self._base, self._quality = world, base, quality
        self._wait = wait
        self._robots = [_Robot(node, camera, prefix) for prefix in prefixes]
        self._process: CameraProcess | None = None  # of the jobs, which come one after the other
        self._busy = self._started = False
        self._try_at = 0.0
        self._count = FrameCount(camera.rate)
        node.on_end(self._end)

    @property
    def wanted(self) -> bool:
        """Return whether to draw pictures: there is a subscriber, and no recent failure."""
        return any(robot.wanted for robot in self._robots) and self._node.steady() >= self._try_at

    def publish(self, stamp: int, state: npt.NDArray[np.float64]) -> None:
        """Draw the picture that is due at a time (ns); called between ticks."""
        if short := self._count.note(stamp * 1e-9, made=not self._busy):
            self._node.log.warn(short)
        if self._busy:
            return
        self._busy = self._started = True
        wants = [(each.wants_pixels, each.wants_jpeg) if each.wanted else None for each in self._robots]

        def on_drawn(drawn: list[Drawing | None] | UserError) -> None:
            self._busy = False
            if isinstance(drawn, UserError):
                self._report(drawn)
                return
            for robot, drawing in zip(self._robots, drawn, strict=True):
                if drawing:
                    robot.send(stamp, drawing)

        if self._wait:
            on_drawn(self._draw(state, wants))
        else:
            self._node.work(lambda: self._draw(state, wants), on_drawn)

    def _draw(
        self, state: npt.NDArray[np.float64], wants: Sequence[tuple[bool, bool] | None]
    ) -> list[Drawing | None] | UserError:
        """Draw the pictures for each robot's subscribers, or return why that fails."""
        try:
            process = self._process = self._process or self._open()
            return [
                process.render(number, state, pixels=want[0], jpeg=want[1]) if want else None
                for number, want in enumerate(wants)
            ]
        except UserError as problem:
            self._close()
            return problem

    def _open(self) -> CameraProcess:
        process = CameraProcess(self._world, self._base, self.camera, len(self._robots), quality=self._quality)
        if process.warning:
            self._node.log.warn(process.warning)
        return process

    def _report(self, problem: UserError) -> None:
        self._try_at = self._node.steady() + _TRY_EVERY
        self._node.log.error("; ".join([str(problem), *(each.help for each in problem.diagnostics if each.help)]))

    def _end(self) -> None:
        if process := self._process:
            process.kill()  # where a computer draws slowly, a picture and the normal end take longer than a node gets
        if self._started:
            self._node.work(self._close, lambda _none: None)  # after what is being drawn

    def _close(self) -> None:
        process, self._process = self._process, None
        if process:
            process.close()


class _Robot:
    def __init__(self, node: Node, camera: Camera, prefix: str) -> None:
        name = f"{prefix}{camera.name}"
        self._raw = node.publish(f"{name}/image_raw", Picture)
        self._compressed = node.publish(f"{name}/image/compressed", PackedPicture)
        self._info = node.publish(f"{name}/camera_info", Calibration)
        self._calibration = calibration(camera, f"{prefix}{camera.frame}")

    @property
    def wants_pixels(self) -> bool:
        return self._raw.subscribers() > 0

    @property
    def wants_jpeg(self) -> bool:
        return self._compressed.subscribers() > 0

    @property
    def wanted(self) -> bool:
        return self.wants_pixels or self.wants_jpeg or self._info.subscribers() > 0

    def send(self, stamp: int, drawing: Drawing) -> None:
        own = self._calibration
        self._info.send(replace(own, stamp=stamp))
        if drawing.pixels:
            self._raw.send(Picture(stamp, own.frame, own.width, own.height, "rgb8", 3 * own.width, drawing.pixels))
        if drawing.jpeg:
            self._compressed.send(PackedPicture(stamp, own.frame, "jpeg", drawing.jpeg))


def calibration(camera: Camera, frame: str) -> Calibration:
    """Return the calibration of a camera without distortion; the centre of the first pixel is (0, 0), as in OpenCV."""
    f, cx, cy = camera.focal_length, (camera.width - 1) / 2.0, (camera.height - 1) / 2.0
    return Calibration(
        stamp=0,
        frame=frame,
        width=camera.width,
        height=camera.height,
        model="plumb_bob",
        distortion=(0.0,) * 5,
        matrix=(f, 0.0, cx, 0.0, f, cy, 0.0, 0.0, 1.0),
        rectification=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        projection=(f, 0.0, cx, 0.0, 0.0, f, cy, 0.0, 0.0, 0.0, 1.0, 0.0),
    )
