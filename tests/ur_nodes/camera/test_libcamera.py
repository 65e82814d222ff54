"""The process that reads libcamera, with a stand-in for picamera2. On a Raspberry Pi it was not tried."""

import sys
from pathlib import Path

import pytest
from tests.ur_nodes.camera.fake_device import make_jpeg

from ur_nodes.camera.libcamera import LibcameraCamera, list_controls
from ur_nodes.camera.libcamera_program import __file__ as program
from ur_nodes.camera.source import Adjustments, CameraError, CameraSettings

# As little of picamera2 as the program uses; names as in its manual.
PICAMERA2 = """
import json, os, threading

class Picamera2:
    def __init__(self, number):
        if os.path.exists(FOLDER + "/busy"):
            raise RuntimeError("Camera __init__ sequence did not complete.")

    @staticmethod
    def global_camera_info():
        return [{"Model": "imx219", "Num": 0}] if not os.path.exists(FOLDER + "/none") else []

    def create_video_configuration(self, **values):
        print("picamera2 prints to standard output")
        open(FOLDER + "/configuration", "w").write(json.dumps(values, default=vars))
        return values

    def configure(self, configuration):
        self.configuration = configuration

    def camera_configuration(self):
        return self.configuration

    def start_recording(self, encoder, output, quality=None):
        open(FOLDER + "/quality", "w").write(quality)
        picture = open(FOLDER + "/picture.jpg", "rb").read()
        output.target.write(picture)

    def stop_recording(self):
        open(FOLDER + "/stopped", "w").write("")
"""
ENCODERS = """
class MJPEGEncoder: ...
class Quality:
    VERY_LOW, LOW, MEDIUM, HIGH, VERY_HIGH = "very low", "low", "medium", "high", "very high"
"""
OUTPUTS = "class FileOutput:\n    def __init__(self, target):\n        self.target = target\n"
TRANSFORM = "class Transform:\n    def __init__(self, hflip, vflip):\n        self.hflip, self.vflip = hflip, vflip\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    package = tmp_path / "picamera2"
    package.mkdir()
    (package / "__init__.py").write_text(f"FOLDER = {str(tmp_path)!r}\n{PICAMERA2}")
    (package / "encoders.py").write_text(ENCODERS)
    (package / "outputs.py").write_text(OUTPUTS)
    (tmp_path / "libcamera.py").write_text(TRANSFORM)
    (tmp_path / "picture.jpg").write_bytes(make_jpeg())
    return tmp_path


def command(folder: Path) -> list[str]:
    start = f"import runpy, sys; sys.path.insert(0, {str(folder)!r}); runpy.run_path({program!r}, run_name='__main__')"
    return [sys.executable, "-I", "-c", start]


def test_pictures_of_libcamera_arrive_and_its_process_ends_with_the_camera(folder: Path) -> None:
    asked = CameraSettings(width=320, height=240, quality=80, flip_horizontally=True)
    camera = LibcameraCamera(0, asked, command(folder))
    mode = camera.mode
    assert (mode.camera, mode.width, mode.height, mode.passed_on) == ("imx219", 320, 240, True)
    frame = camera.read(30.0)
    assert frame is not None
    assert frame.jpeg == make_jpeg()
    camera.close()
    camera.close()
    assert (folder / "stopped").exists()
    assert (folder / "quality").read_text() == "high"
    assert '"hflip": true' in (folder / "configuration").read_text()


def test_without_picamera2_its_package_is_named() -> None:
    empty = [sys.executable, "-I", "-S", program]
    with pytest.raises(CameraError, match="picamera2 cannot be imported") as caught:
        LibcameraCamera(0, CameraSettings(), empty)
    assert "python3-picamera2" in caught.value.help


@pytest.mark.parametrize(
    ("state", "message"),
    [("none", "libcamera finds no camera 0, counted from 0; it finds none"), ("busy", "cannot start the camera")],
)
def test_missing_and_busy_cameras_are_reported(folder: Path, state: str, message: str) -> None:
    (folder / state).touch()
    with pytest.raises(CameraError, match=message):
        LibcameraCamera(0, CameraSettings(), command(folder))


@pytest.mark.parametrize("line", ["no JSON", "[1, 2]", '{"camera": "x"}', '{"width": 2, "height": 2}\\n' + "x" * 99])
def test_process_that_answers_nonsense_is_ended(line: str) -> None:
    shell = ["sh", "-c", f"printf '{line}\\n'; cat >/dev/null"]
    with pytest.raises(CameraError, match=r"nonsense|ended"):
        LibcameraCamera(0, CameraSettings(), shell).read(5.0)


def test_process_that_ends_is_reported() -> None:
    with pytest.raises(CameraError, match="has ended"):
        LibcameraCamera(0, CameraSettings(), ["true"])


def test_missing_python_is_reported() -> None:
    with pytest.raises(CameraError, match="/nowhere/python3, which cannot be started"):
        LibcameraCamera(0, CameraSettings(), ["/nowhere/python3"])


def test_adjustments_are_on_the_scales_of_libcamera() -> None:
    asked = Adjustments(brightness=75, contrast=-50, shutter_speed=20_000)
    assert list_controls(asked) == {"Brightness": 0.5, "Contrast": 0.5, "ExposureTime": 20_000}
    assert list_controls(Adjustments(shutter_speed=0)) == {}
