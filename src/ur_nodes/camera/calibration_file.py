"""The file of a camera's calibration: the YAML of ROS's camera_calibration_parsers.

Matrices are row by row, in pixels, with the centre of the first pixel at (0, 0). REP 104 describes the models of
distortion.
"""

import json
import math
import os
import re
from collections.abc import Callable
from pathlib import Path
from urllib.parse import unquote

from ur.source.diagnostic import user_error
from ur.source.file import SourceFile
from ur.source.read import read_source
from ur.source.replace import replace_file
from ur.source.section import Section, parse_section
from ur_nodes.ports.values import Calibration
from ur_nodes.run import find_package

MODELS = {"plumb_bob": (5,), "rational_polynomial": (8,), "equidistant": (4,)}
_WHAT = "a calibration of a camera"
_BARE_EXPONENT = re.compile(r"(?<=[\[, ])(-?\d+)(e[+-]?\d+)(?=[\], \n])")


class CalibrationStore:
    """Keeps the calibration of the camera `name`."""

    def __init__(self, url: str, name: str) -> None:
        """Load the file of the URL, else that of the camera's name. Raises UserError if it cannot be read."""
        home = Path(os.environ.get("ROS_HOME") or Path.home() / ".ros")
        self._name = name
        own = resolve_url(url, name, home, find_package)
        stored = default_path(name, home)
        named = own if own and not url.startswith("package://") else None
        # As with camera_info_manager, what was stored for this camera is preferred to what a package holds.
        self.path = named or stored
        places = [each for each in (named, stored, own) if each]
        self.found = next((each for each in places if each.is_file()), None)
        self.calibration = read_calibration(self.found) if self.found else None

    def write(self, calibration: Calibration) -> None:
        """Write the file. Raises UserError."""
        write_calibration(self.path, calibration, self._name)

    def use(self, calibration: Calibration) -> None:
        """Use a calibration that has been written."""
        self.calibration, self.found = calibration, self.path


def find_problem(calibration: Calibration) -> str:
    """Return the reason why a calibration is invalid; '' for a valid one."""
    known, matrix = MODELS.get(calibration.model), calibration.matrix
    if known is None:
        return f"distortion_model {calibration.model!r}, expected one of {', '.join(MODELS)}"
    if len(calibration.distortion) not in known:
        return f"{len(calibration.distortion)} numbers of distortion, expected {known[0]}"
    numbers = (*calibration.distortion, *matrix, *calibration.rectification, *calibration.projection)
    if not all(map(math.isfinite, numbers)) or matrix[0] <= 0.0 or matrix[4] <= 0.0:
        return "a camera matrix K without focal lengths"
    return ""


def read_calibration(path: Path) -> Calibration:
    """Read a file. Raises UserError with file, line and column."""
    return parse_calibration(read_source(path, expected=_WHAT).text, str(path))


def parse_calibration(text: str, path: str) -> Calibration:
    """Read the text of a file. Raises UserError."""
    # C++ writes 1e-05, which is no number in YAML 1.1.
    return _read(parse_section(SourceFile(path, _BARE_EXPONENT.sub(r"\1.0\2", text)), _WHAT))


def write_calibration(path: Path, calibration: Calibration, name: str) -> None:
    """Write the file of the camera `name`, completely or not at all. Raises UserError."""
    try:
        replace_file(path, format_calibration(calibration, name), parents=True)
    except OSError as problem:
        reason = (problem.strerror or str(problem)).lower()
        raise user_error(f"{path}: {reason}, expected a file that this user can write", rule="bad-file") from None


def format_calibration(calibration: Calibration, name: str) -> str:
    """Return the text of the file of the camera `name`."""
    matrices = (
        ("camera_matrix", 3, 3, calibration.matrix),
        ("distortion_coefficients", 1, len(calibration.distortion), calibration.distortion),
        ("rectification_matrix", 3, 3, calibration.rectification),
        ("projection_matrix", 3, 4, calibration.projection),
    )
    lines = [
        f"image_width: {calibration.width}",
        f"image_height: {calibration.height}",
        f"camera_name: {json.dumps(name)}",
        f"distortion_model: {calibration.model}",
    ]
    for title, rows, columns, data in matrices:
        numbers = ", ".join(repr(float(f"{value:.10g}")) for value in data)
        lines += [f"{title}:", f"  rows: {rows}", f"  cols: {columns}", f"  data: [{numbers}]"]
    return "\n".join(lines) + "\n"


def default_path(name: str, ros_home: Path) -> Path:
    """Return the default file of a camera, that of ROS's camera_info_manager."""
    return ros_home / "camera_info" / f"{name}.yaml"


def resolve_url(url: str, name: str, ros_home: Path, find_package: Callable[[str], str | Path | None]) -> Path | None:
    """Return the file of a `camera_info_url`: `file:///PATH`, `package://PACKAGE/PATH`, or a path.

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
    raise user_error(
        f"camera_info_url: {url!r}, expected file:///PATH, package://PACKAGE/PATH or a path", rule="bad-parameter"
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
    top.text("camera_name", "camera")
    return Calibration(
        stamp=0,
        frame="",
        width=top.integer("image_width", minimum=1),
        height=top.integer("image_height", minimum=1),
        model=model,
        distortion=numbers,
        matrix=_matrix(top, "camera_matrix", 9),
        rectification=_matrix(top, "rectification_matrix", 9),
        projection=_matrix(top, "projection_matrix", 12),
    )


def _matrix(top: Section, name: str, length: int | None) -> tuple[float, ...]:
    return top.section(name).numbers("data", length)
