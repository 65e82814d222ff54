"""The topics of a camera: its pictures in the forms that have subscribers, and its calibration."""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from ur_nodes.camera.calibration_file import CalibrationStore
from ur_nodes.camera.finder import CameraFinder
from ur_nodes.camera.formats import decode_jpeg, encode_jpeg
from ur_nodes.camera.source import CameraError, Frame, Mode
from ur_nodes.pictures.decode import BadPictureError, Pixels, make_picture
from ur_nodes.ports.node import SECOND, Node
from ur_nodes.ports.values import Calibration, PackedPicture, Picture


@dataclass(frozen=True, slots=True)
class Shot:
    """A picture in the forms with subscribers: its age in s, JPEG data, pixels, or the reason why there is none."""

    age: float
    jpeg: bytes = b""
    pixels: Pixels | None = None
    problem: str = ""


class CameraTopics:
    """Publishes pictures of a camera while topics have subscribers. A `Consumer` of a `CameraLoop`."""

    def __init__(self, node: Node, frame: str, quality: int, store: CalibrationStore, finder: CameraFinder) -> None:
        self._node = node
        self._compressed = node.publish("~image/compressed", PackedPicture)
        self._raw = node.publish("~image", Picture)
        self._info = node.publish("~camera_info", Calibration)
        self._frame, self._quality, self._store, self._finder = frame, quality, store, finder
        self._mode: Mode | None = None
        self._calibration = describe_camera(None, 0, 0, "")

    def ask(self) -> tuple[bool, Callable[[Frame], Shot]]:
        packed, raw = bool(self._compressed.subscribers()), bool(self._raw.subscribers())
        return packed or raw, partial(make_shot, packed=packed, raw=raw, quality=self._quality)

    def begin(self, mode: Mode) -> None:
        """See Consumer: log the camera and the mode of its pictures."""
        self._mode = mode
        rate = f"{mode.rate:g} pictures/s" if mode.rate else "a rate that it does not tell"
        how = "JPEG passed on" if mode.passed_on else f"{mode.format}, encoded as JPEG here"
        name = self._finder.description or mode.camera
        self._node.log.info(f"camera: {name}: {mode.width} x {mode.height}, {rate}, {how}")
        if mode.missing:
            missing = ", ".join(mode.missing)
            self._node.log.warn(f"the camera {mode.camera} cannot set {missing}: left as it is")
        self.update_calibration()

    def update_calibration(self) -> None:
        """Publish the calibration of the store from now on, if it was made from pictures of this size."""
        mode, calibration = self._mode, self._store.calibration
        if mode is None:
            return
        if calibration and (calibration.width, calibration.height) != (mode.width, mode.height):
            self._node.log.warn(
                f"{self._store.found} is a calibration of pictures of {calibration.width} x {calibration.height},"
                f" not {mode.width} x {mode.height}: it is not used"
            )
            calibration = None
        elif calibration is None:
            self._node.log.info(
                f"the camera is not calibrated; ur run calibrate_camera does it, and writes {self._store.path}"
            )
        self._calibration = describe_camera(calibration, mode.width, mode.height, self._frame)

    def on_shot(self, shot: Shot) -> None:
        stamp = max(0, self._node.now() - round(shot.age * SECOND))
        if self._info.subscribers():
            self._info.send(replace(self._calibration, stamp=stamp))
        if shot.jpeg:
            self._compressed.send(PackedPicture(stamp, self._frame, "jpeg", shot.jpeg))
        if shot.pixels is not None:
            self._raw.send(make_picture(shot.pixels, stamp, self._frame))
        if shot.problem:
            self._node.log.warn(f"a picture is left out: {shot.problem}", every=10.0)

    def report(self, problem: CameraError) -> None:
        """See Consumer. `ur_nodes.pictures.feed` repeats the problem while pictures are missing."""
        self._node.log.error(str(problem))


def make_shot(frame: Frame, *, packed: bool, raw: bool, quality: int) -> Shot:
    """Convert a picture to the forms with subscribers; an empty picture has none."""
    began = time.monotonic()
    jpeg, pixels, problem = b"", frame.pixels, ""
    if packed:
        jpeg = frame.jpeg or (encode_jpeg(pixels, quality) if pixels is not None else b"")
    if not raw:
        pixels = None
    elif frame.jpeg and pixels is None:
        try:
            pixels = decode_jpeg(frame.jpeg)
        except BadPictureError as bad:
            problem = str(bad)
    return Shot(frame.age + time.monotonic() - began, jpeg, pixels, problem)


def describe_camera(calibration: Calibration | None, width: int, height: int, frame: str) -> Calibration:
    """Return the calibration of the camera at `frame`; all matrices are 0 without one (REP 104)."""
    if calibration is None:
        square = (0.0,) * 9
        return Calibration(0, frame, width, height, "", (), square, square, (0.0,) * 12)
    return replace(calibration, frame=frame)
