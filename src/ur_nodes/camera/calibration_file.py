"""A camera's calibration, and its file: the YAML of ROS's camera_calibration_parsers.

Matrices are row by row: `camera_matrix` (3, 3) in pixels, with the centre of the first pixel at (0, 0);
`rectification` (3, 3); `projection` (3, 4) of the rectified picture. REP 104 describes the models of distortion.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

from ur.source.diagnostic import UserError, error
from ur.source.file import SourceFile
from ur.source.read import read_source
from ur.source.replace import replace_file
from ur.source.section import Section, parse_section

MODELS = {"plumb_bob": (5,), "rational_polynomial": (8,), "equidistant": (4,)}
_WHAT = "a calibration of a camera"
_BARE_EXPONENT = re.compile(r"(?<=[\[, ])(-?\d+)(e[+-]?\d+)(?=[\], \n])")


@dataclass(frozen=True, slots=True)
class Calibration:
    """See the module. `distortion` has as many numbers as its model needs."""

    name: str
    width: int
    height: int
    model: str
    distortion: tuple[float, ...]
    camera_matrix: tuple[float, ...]
    rectification: tuple[float, ...]
    projection: tuple[float, ...]

    @property
    def is_set(self) -> bool:
        """Return whether the camera is calibrated (REP 104: K is 0 otherwise)."""
        return self.camera_matrix[0] > 0.0 and self.camera_matrix[4] > 0.0


def read_calibration(path: Path) -> Calibration:
    """Read a file. Raises UserError with file, line and column."""
    return parse_calibration(read_source(path, expected=_WHAT).text, str(path))


def parse_calibration(text: str, path: str) -> Calibration:
    """Read the text of a file. Raises UserError."""
    # C++ writes 1e-05, which is no number in YAML 1.1.
    return _read(parse_section(SourceFile(path, _BARE_EXPONENT.sub(r"\1.0\2", text)), _WHAT))


def write_calibration(path: Path, calibration: Calibration) -> None:
    """Write a file; it is complete or stays as it was. Raises UserError."""
    try:
        replace_file(path, format_calibration(calibration), parents=True)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise UserError(error(f"{path}: {reason}, expected a file that this user can write", rule="bad-file")) from None


def format_calibration(calibration: Calibration) -> str:
    """The text of a file."""
    matrices = (
        ("camera_matrix", 3, 3, calibration.camera_matrix),
        ("distortion_coefficients", 1, len(calibration.distortion), calibration.distortion),
        ("rectification_matrix", 3, 3, calibration.rectification),
        ("projection_matrix", 3, 4, calibration.projection),
    )
    lines = [
        f"image_width: {calibration.width}",
        f"image_height: {calibration.height}",
        f"camera_name: {json.dumps(calibration.name)}",
        f"distortion_model: {calibration.model}",
    ]
    for name, rows, columns, data in matrices:
        numbers = ", ".join(repr(float(f"{value:.10g}")) for value in data)
        lines += [f"{name}:", f"  rows: {rows}", f"  cols: {columns}", f"  data: [{numbers}]"]
    return "\n".join(lines) + "\n"


def default_path(name: str, ros_home: Path) -> Path:
    """The file of a camera that needs no URL, as ROS's camera_info_manager places it."""
    return ros_home / "camera_info" / f"{name}.yaml"


def resolve_url(url: str, name: str, ros_home: Path, find_package: Callable[[str], str | None]) -> Path | None:
    """The file that a `camera_info_url` means: `file:///PATH`, `package://PACKAGE/PATH`, or a path.

    `${NAME}` and `${ROS_HOME}` are replaced. None for '' and for a package that is not installed. Raises UserError.
    """
    text = url.replace("${NAME}", name).replace("${ROS_HOME}", str(ros_home))
    if not text:
        return None
    if text.startswith("file://"):
        return Path(unquote(text.removeprefix("file://")))
    if text.startswith("package://"):
        package, _, rest = text.removeprefix("package://").partition("/")
        folder = find_package(package)
        path = os.path.normpath(rest)
        if folder is None or not rest or path.startswith(("..", "/")):
            return None
        return Path(folder) / path
    if "://" not in text:
        return Path(text).expanduser()
    raise UserError(
        error(
            f"camera_info_url: {url!r}, expected file:///PATH, package://PACKAGE/PATH or a path", rule="bad-parameter"
        )
    )


def _read(top: Section) -> Calibration:
    model = top.text("distortion_model", "plumb_bob", choices=MODELS)
    numbers = _matrix(top, "distortion_coefficients", None)
    if len(numbers) not in MODELS[model]:
        expected = " or ".join(map(str, MODELS[model]))
        top.fail(
            "distortion_coefficients",
            f"distortion_coefficients: {len(numbers)} numbers, expected {expected} of the model {model}",
        )
    return Calibration(
        name=top.text("camera_name", "camera"),
        width=top.integer("image_width", minimum=1),
        height=top.integer("image_height", minimum=1),
        model=model,
        distortion=numbers,
        camera_matrix=_matrix(top, "camera_matrix", 9),
        rectification=_matrix(top, "rectification_matrix", 9),
        projection=_matrix(top, "projection_matrix", 12),
    )


def _matrix(top: Section, name: str, length: int | None) -> tuple[float, ...]:
    return top.section(name).numbers("data", length)
