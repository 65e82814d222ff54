"""The visible part of the model beside the shapes of physics: light, colours, fiducials, and the camera itself."""

import math
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from ur.robot.base import Camera
from ur.worlds.world_file import DICTIONARIES, Fiducial
from ur_nodes.geometry.rigid import from_angles
from ur_nodes.simulator.mujoco_model import Scenery

_CELL_PIXELS = 16


def build_scenery(camera: Camera, fiducials: Iterable[Fiducial], robots: int) -> Scenery:
    """Scenery with cameras `camera_<n>`, and plates for fiducials whose textures are files `<texture_name>.png`."""
    plates = tuple(fiducials)
    # Shadows cost more than the rest of a picture in software; samples make edges smooth, which detection needs.
    options = (
        f'<visual><global offwidth="{camera.width}" offheight="{camera.height}"/>'
        '<quality shadowsize="0" offsamples="4"/><map znear="0.002" zfar="5"/>'
        '<headlight ambient="0.75 0.75 0.75" diffuse="0.25 0.25 0.25" specular="0 0 0"/></visual>'
    )
    assets = (
        '<texture type="skybox" builtin="gradient" rgb1="0.75 0.77 0.80" rgb2="0.45 0.47 0.50" width="64" height="64"/>'
        + "".join(_asset(plate) for plate in plates)
    )
    return Scenery(
        options, assets, "".join(_plate(plate) for plate in plates), tuple(_camera(camera, n) for n in range(robots))
    )


def texture_name(fiducial: Fiducial) -> str:
    """The name of the picture of a fiducial: it does not depend on size and place."""
    return f"fiducial_{fiducial.dictionary}_{fiducial.id}"


def plate_cells(fiducial: Fiducial) -> int:
    """Cells along the edge of a plate: the marker, its black border, and a white margin of one cell."""
    return DICTIONARIES[fiducial.dictionary][0] + 4


def draw_textures(fiducials: Iterable[Fiducial]) -> dict[str, bytes]:
    """PNG files of the plates by name (`<texture_name>.png`). Raises ImportError for plates without OpenCV."""
    plates = tuple(fiducials)
    if not plates:
        return {}
    import cv2

    files = {}
    for fiducial in plates:
        dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, f"DICT_{fiducial.dictionary}"))
        cells = plate_cells(fiducial)
        marker = cv2.aruco.generateImageMarker(dictionary, fiducial.id, (cells - 2) * _CELL_PIXELS)
        plate = np.pad(marker, _CELL_PIXELS, constant_values=255)
        files[f"{texture_name(fiducial)}.png"] = cv2.imencode(".png", plate)[1].tobytes()
    return files


def rotation_axes(angles: Sequence[float]) -> NDArray[np.float64]:
    """The axes (3, 3) of a frame turned by roll, pitch, yaw (rad, about fixed axes, as in URDF), in its parent."""
    axes: NDArray[np.float64] = from_angles((0.0, 0.0, 0.0), tuple(angles))[:3, :3].T
    return axes


def _camera(camera: Camera, number: int) -> str:
    """MuJoCo's cameras look along -z with y up; `fovy` is in degrees under any setting of the compiler."""
    _, left, up = rotation_axes(camera.pose[3:])
    fovy = 2.0 * math.degrees(math.atan(camera.height / 2.0 / camera.focal_length))
    return f'<camera name="camera_{number}" pos="{_n(camera.pose[:3])}" xyaxes="{_n((*-left, *up))}" fovy="{fovy!r}"/>'


def _asset(plate: Fiducial) -> str:
    name = texture_name(plate)
    return (
        f'<texture name="{name}" type="2d" file="{name}.png"/>'
        f'<material name="{name}" texture="{name}" texrepeat="1 1" texuniform="false" specular="0"/>'
    )


def _plate(plate: Fiducial) -> str:
    x_axis, y_axis, _ = rotation_axes(plate.pose[3:])
    cells = plate_cells(plate)
    half = plate.size * cells / (cells - 2) / 2.0
    return (
        f'<geom name="fiducial/{plate.id}" type="plane" pos="{_n(plate.pose[:3])}" xyaxes="{_n((*x_axis, *y_axis))}"'
        f' size="{half!r} {half!r} 0.01" material="{texture_name(plate)}" contype="0" conaffinity="0" group="0"/>'
    )


def _n(values: Iterable[float]) -> str:
    return " ".join(repr(float(value)) for value in values)
