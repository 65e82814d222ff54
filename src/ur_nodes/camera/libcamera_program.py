"""Take pictures with picamera2; runs alone, by the Python of the system, whose NumPy picamera2 was built for.

The argument is a JSON object: number, width, height, rate, quality, flip_horizontally, flip_vertically, controls. The
output is a line of JSON, {"camera": name, "width": ..., "height": ...} or {"error": ..., "help": ...}, and then for
each picture a head of 16 bytes (length, steady time in s; little-endian) and a JPEG. It ends with its input.
"""

import io
import json
import os
import struct
import sys
import threading
import time
from importlib import import_module
from typing import Any

HEAD = struct.Struct("<qd")
_INSTALL = "sudo apt-get install python3-picamera2; Raspberry Pi OS 12 and 13 have it"


class PictureSender(io.BufferedIOBase):
    """A file to which an encoder writes; sends each picture with a header."""

    def __init__(self, target: int) -> None:
        self._target = target

    def writable(self) -> bool:
        """See io."""
        return True

    def write(self, data: Any) -> int:
        """Send a picture; the process ends when there is no reader."""
        picture = bytes(data)
        try:
            _write(self._target, HEAD.pack(len(picture), time.monotonic()) + picture)
        except OSError:
            os._exit(0)
        return len(picture)


def main() -> int:
    """Run the program. Returns the exit code."""
    wanted = json.loads(sys.argv[1])
    target = os.dup(1)
    os.dup2(2, 1)  # libcamera and picamera2 print
    try:
        picamera2 = import_module("picamera2")
    except ImportError as problem:
        return _fail(target, f"picamera2 cannot be imported: {problem}", _INSTALL)
    cameras = picamera2.Picamera2.global_camera_info()
    if wanted["number"] >= len(cameras):
        listed = ", ".join(str(each.get("Model", "?")) for each in cameras) or "none"
        return _fail(target, f"libcamera finds no camera {wanted['number']}, counted from 0; it finds {listed}", "")
    try:
        camera = picamera2.Picamera2(wanted["number"])
        start(camera, wanted, target, str(cameras[wanted["number"]].get("Model", "camera")))
    except (RuntimeError, OSError, ValueError, IndexError) as problem:
        return _fail(target, f"libcamera cannot start the camera: {problem}", "does another program use it?")
    while os.read(0, 4096):
        pass
    camera.stop_recording()
    return 0


def start(camera: Any, wanted: Any, target: int, name: str) -> None:
    """Configure the camera, and begin to send pictures."""
    encoders, outputs = import_module("picamera2.encoders"), import_module("picamera2.outputs")
    transform = import_module("libcamera").Transform(
        hflip=bool(wanted["flip_horizontally"]), vflip=bool(wanted["flip_vertically"])
    )
    configuration = camera.create_video_configuration(
        main={"size": (wanted["width"], wanted["height"])},
        transform=transform,
        controls={"FrameRate": wanted["rate"], **wanted["controls"]},
    )
    camera.configure(configuration)
    width, height = camera.camera_configuration()["main"]["size"]
    quality = encoders.Quality
    steps = (quality.VERY_LOW, quality.LOW, quality.MEDIUM, quality.HIGH, quality.VERY_HIGH)
    _write(target, json.dumps({"camera": name, "width": width, "height": height}).encode() + b"\n")
    step = steps[min(max(int(wanted["quality"]) - 1, 0) // 20, 4)]
    camera.start_recording(encoders.MJPEGEncoder(), outputs.FileOutput(PictureSender(target)), quality=step)


def _fail(target: int, reason: str, help: str) -> int:
    _write(target, json.dumps({"error": reason, "help": help}).encode() + b"\n")
    return 1


def _write(target: int, data: bytes) -> None:
    view = memoryview(data)
    while view:
        view = view[os.write(target, view) :]


if __name__ == "__main__":
    threading.excepthook = lambda _: os._exit(1)
    sys.exit(main())
