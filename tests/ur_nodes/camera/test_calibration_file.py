from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from ur.source.diagnostic import UserError
from ur_nodes.camera.calibration_file import (
    default_path,
    find_problem,
    format_calibration,
    parse_calibration,
    read_calibration,
    resolve_url,
    write_calibration,
)
from ur_nodes.ports.values import Calibration

CALIBRATION = Calibration(
    stamp=0,
    frame="",
    width=640,
    height=480,
    model="plumb_bob",
    distortion=(0.1, -0.25, 1e-05, 0.0, 0.0),
    matrix=(531.25, 0.0, 319.5, 0.0, 530.0, 239.5, 0.0, 0.0, 1.0),
    rectification=(1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
    projection=(531.25, 0.0, 319.5, 0.0, 0.0, 530.0, 239.5, 0.0, 0.0, 0.0, 1.0, 0.0),
)


def test_written_calibration_is_read_back_the_same(tmp_path: Path) -> None:
    path = tmp_path / "camera_info" / "camera.yaml"
    write_calibration(path, CALIBRATION, "camera")
    assert read_calibration(path) == CALIBRATION


def test_numbers_without_a_point_before_the_exponent_are_read() -> None:
    text = format_calibration(CALIBRATION, "camera").replace("1e-05", "-2e-05").replace("[0.1,", "[1e-3,")
    assert parse_calibration(text, "camera.yaml").distortion[:3] == (0.001, -0.25, -2e-05)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("image_width: 640", "image_width: 0", "expected at least 1"),
        ("plumb_bob", "plum_bob", "expected one of plumb_bob"),
        ("data: [531.25, 0.0", "data: [531.25", "expected a list of"),
        ("data: [0.1, ", "data: [", "4 numbers, expected 5 of the model plumb_bob"),
        ("camera_matrix:", "camera_matrices:", "camera_matrix"),
    ],
)
def test_mistake_is_named_with_its_place(old: str, new: str, message: str) -> None:
    text = format_calibration(CALIBRATION, "camera")
    assert old in text
    with pytest.raises(UserError) as caught:
        parse_calibration(text.replace(old, new, 1), "camera.yaml")
    assert message in str(caught.value)


def test_file_that_cannot_be_written_is_reported(tmp_path: Path) -> None:
    (tmp_path / "camera_info").write_text("a file in place of the folder")
    with pytest.raises(UserError, match="expected a file that this user can write"):
        write_calibration(tmp_path / "camera_info" / "camera.yaml", CALIBRATION, "camera")


def test_urls_mean_what_they_mean_for_camera_info_manager(tmp_path: Path) -> None:
    def find_package(name: str) -> str | None:
        return "/opt/cameras" if name == "cameras" else None

    def resolve(url: str) -> Path | None:
        return resolve_url(url, "left", tmp_path, find_package)

    assert resolve("file:///etc/a%20b/${NAME}.yaml") == Path("/etc/a b/left.yaml")
    assert resolve("file://${ROS_HOME}/x.yaml") == tmp_path / "x.yaml"
    assert resolve("package://cameras/info/left.yaml") == Path("/opt/cameras/info/left.yaml")
    assert resolve("package://cameras/../secret.yaml") is None
    assert resolve("package://nowhere/left.yaml") is None
    assert resolve("") is None
    assert resolve("/etc/left.yaml") == Path("/etc/left.yaml")
    with pytest.raises(UserError, match="expected file:///PATH"):
        resolve("http://example.com/left.yaml")
    assert default_path("left", tmp_path) == tmp_path / "camera_info" / "left.yaml"


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({}, ""),
        ({"model": "fisheye"}, "distortion_model 'fisheye', expected one of plumb_bob"),
        ({"distortion": (0.0,) * 4}, "4 numbers of distortion, expected 5"),
        ({"matrix": (0.0,) * 9}, "a camera matrix K without focal lengths"),
        ({"distortion": (float("nan"),) * 5}, "a camera matrix K without focal lengths"),
    ],
)
def test_calibration_that_cannot_be_one_has_a_reason(change: dict[str, Any], problem: str) -> None:
    assert find_problem(replace(CALIBRATION, **change)).startswith(problem)
    assert bool(find_problem(replace(CALIBRATION, **change))) == bool(problem)
