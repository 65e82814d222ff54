"""Pictures of libcamera, for cameras on the ribbon of a Raspberry Pi: a process of its own takes them.

picamera2 belongs to the Python of the system and is built for its NumPy; that of this project is another one.
"""

import contextlib
import json
import os
import select
import subprocess
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ur.source.foreign.json_values import BadJsonError, Count, read_json
from ur.source.printable import printable
from ur_nodes.camera.formats import trim_jpeg
from ur_nodes.camera.libcamera_program import HEAD
from ur_nodes.camera.source import Adjustments, CameraError, CameraSettings, Frame, Mode

COMMAND = ("/usr/bin/python3", "-I", str(Path(__file__).with_name("libcamera_program.py")))
_START_SECONDS = 20.0
_LARGEST = 64 << 20  # bytes of a picture


@dataclass(frozen=True, slots=True)
class Greeting:
    """The first line of libcamera_program.py: the camera and its size, or an error and how to fix it."""

    width: Count = 0
    height: Count = 0
    camera: str = "camera"
    error: str = ""
    help: str = ""


class LibcameraCamera:
    """A PictureSource. Not for two threads at once."""

    def __init__(self, number: int, settings: CameraSettings, command: Sequence[str] = COMMAND) -> None:
        """Start taking pictures with the camera of this number, from 0. Raises CameraError."""
        pipe = subprocess.PIPE
        try:
            self._process = subprocess.Popen(
                [*command, json.dumps(describe_request(number, settings))],
                stdin=pipe,
                stdout=pipe,
                stderr=subprocess.DEVNULL,
            )
        except OSError as problem:
            reason = f"libcamera needs {command[0]}, which cannot be started: {problem.strerror}"
            raise CameraError(reason, waits=False) from None
        assert self._process.stdout is not None
        self._output = self._process.stdout.fileno()
        self._data = b""
        try:
            end = time.monotonic() + _START_SECONDS
            while b"\n" not in self._data:
                if not self._fill(max(0.0, end - time.monotonic())):
                    raise CameraError(f"libcamera did not start the camera within {_START_SECONDS:.0f} s")
            line, _, self._data = self._data.partition(b"\n")
            try:
                reported = read_json(line, Greeting)
            except BadJsonError:
                raise CameraError("libcamera's process answered nonsense", "start it anew") from None
            if reported.error:
                raise CameraError(printable(reported.error), printable(reported.help))
            if not reported.width or not reported.height:
                raise CameraError("libcamera's process answered nonsense", "start it anew")
            found = reported
        except CameraError:
            self.close()
            raise
        name = printable(found.camera)
        self._mode = Mode(name, f"libcamera {number}", found.width, found.height, settings.rate, "JPEG", passed_on=True)

    @property
    def mode(self) -> Mode:
        return self._mode

    def read(self, seconds: float, *, wanted: bool = True) -> Frame | None:
        end, newest = time.monotonic() + seconds, None
        while True:
            while (found := self._next_frame(wanted=wanted)) is not None:
                newest = found
            left = 0.0 if newest else end - time.monotonic()
            if not self._fill(max(0.0, left)):
                return newest

    def close(self) -> None:
        for stream in (self._process.stdin, self._process.stdout):
            if stream:
                with contextlib.suppress(OSError):
                    stream.close()
        try:
            self._process.wait(timeout=3.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _fill(self, seconds: float) -> bool:
        """Read more data; False if none arrived within that time. Raises CameraError when the process has ended."""
        if not select.select([self._output], [], [], seconds)[0]:
            return False
        data = os.read(self._output, 1 << 20)
        if not data:
            raise CameraError("libcamera's process has ended", "is the ribbon of the camera in place?")
        self._data += data
        return True

    def _next_frame(self, *, wanted: bool) -> Frame | None:
        if len(self._data) < HEAD.size:
            return None
        length, taken = HEAD.unpack_from(self._data)
        if not 0 < length <= _LARGEST:
            raise CameraError("libcamera's process sent nonsense")
        if len(self._data) < HEAD.size + length:
            return None
        data, self._data = self._data[HEAD.size : HEAD.size + length], self._data[HEAD.size + length :]
        jpeg = trim_jpeg(data) if wanted else b""
        return None if jpeg is None else Frame(min(max(0.0, time.monotonic() - taken), 1.0), jpeg)


def describe_request(number: int, settings: CameraSettings) -> dict[str, object]:
    """Return the request for libcamera_program.py."""
    return {
        "number": number,
        "width": settings.width,
        "height": settings.height,
        "rate": settings.rate,
        "quality": settings.quality,
        "flip_horizontally": settings.flip_horizontally,
        "flip_vertically": settings.flip_vertically,
        "controls": list_controls(settings.adjustments),
    }


def list_controls(adjustments: Adjustments) -> dict[str, object]:
    """Controls of libcamera: brightness from -1 to 1, 1 for other things as they are, exposure in microseconds."""
    found: dict[str, object] = {}
    if adjustments.brightness is not None:
        found["Brightness"] = adjustments.brightness / 50.0 - 1.0
    for name, value in (
        ("Contrast", adjustments.contrast),
        ("Saturation", adjustments.saturation),
        ("Sharpness", adjustments.sharpness),
    ):
        if value is not None:
            found[name] = 1.0 + value / 100.0
    if adjustments.shutter_speed:
        found["ExposureTime"] = adjustments.shutter_speed
    return found
