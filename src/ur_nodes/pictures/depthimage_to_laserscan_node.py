"""A scan of the pictures of a depth camera: the stand-in for depthimage_to_laserscan, with its names."""

import math
import sys
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.values import Calibration, Picture, Scan
from ur_nodes.run import run

_ENCODINGS = {"16UC1": ("<u2", 0.001), "mono16": ("<u2", 0.001), "32FC1": ("<f4", 1.0)}  # of numbers, and m of 1


@dataclass(frozen=True, slots=True)
class ScanSettings:
    """Rows of the picture that count, s for a scan, limits (m), and the frame of the scan, which looks along x."""

    rows: int
    scan_time: float
    range_min: float
    range_max: float
    frame: str


def read_settings(own: Parameters) -> ScanSettings:
    """Read the parameters under upstream's names. Raises UserError."""
    near = own.number("range_min", 0.45, minimum=0.0)
    return ScanSettings(
        own.integer("scan_height", 1, minimum=1),
        own.number("scan_time", 1.0 / 30.0, minimum=0.0),
        near,
        own.number("range_max", 10.0, minimum=near),
        own.text("output_frame", own.text("output_frame_id", "camera_depth_frame")),
    )


def read_depth(picture: Picture) -> NDArray[np.float64] | None:
    """Return the depths (height, width) of a picture in m, 0 or NaN where there is none; None for another encoding."""
    if picture.encoding not in _ENCODINGS:
        return None
    name, unit = _ENCODINGS[picture.encoding]
    kind: np.dtype[np.generic] = np.dtype(name)
    if picture.step < picture.width * kind.itemsize or len(picture.data) < picture.step * picture.height:
        return None
    rows = np.frombuffer(picture.data, np.uint8, picture.step * picture.height).reshape(picture.height, picture.step)
    depths: NDArray[np.float64] = rows[:, : picture.width * kind.itemsize].copy().view(kind) * unit
    return depths


def make_scan(depths: NDArray[np.float64], camera: Calibration, settings: ScanSettings, stamp: int) -> Scan:
    """Return the nearest of the rows in the middle for each direction; NaN without a depth, inf beyond the limit."""
    matrix, width = camera.matrix, depths.shape[1]
    focal, centre_x, centre_y = matrix[0], matrix[2], matrix[5]
    sides = (np.arange(width) - centre_x) / focal
    first, last = -math.atan(float(sides[-1])), -math.atan(float(sides[0]))
    step = (last - first) / max(1, width - 1)
    top = max(0, min(depths.shape[0] - 1, round(centre_y - settings.rows / 2.0)))
    band = depths[top : top + settings.rows]
    near = np.where(np.isfinite(band) & (band > 0.0), band, np.inf).min(axis=0) * np.hypot(1.0, sides)
    seen = (np.isposinf(band) | (band > 0.0)).any(axis=0)
    near[near >= settings.range_max] = np.inf
    ranges = np.full(width, np.inf)
    columns = np.round((-np.arctan(sides) - first) / step).astype(np.intp)
    counts = seen & (near >= settings.range_min)
    np.minimum.at(ranges, columns[counts], near[counts])
    known = np.zeros(width, bool)
    known[columns[counts]] = True
    ranges[~known] = np.nan
    limits = settings.range_min, settings.range_max
    return Scan(
        stamp, settings.frame, first, step, *limits, ranges.astype(np.float32), scan_time=settings.scan_time,
        angle_max=last,
    )  # fmt: skip


def start(node: Node) -> None:
    """Make a scan of each picture once the camera has sent its calibration."""
    settings = read_settings(node.parameters)
    scans = node.publish("scan", Scan)
    cameras: list[Calibration] = []

    def on_picture(picture: Picture) -> None:
        depths = read_depth(picture)
        if depths is None or not depths.size:
            expected = "expected a picture of depths, 16UC1 or 32FC1"
            node.log.warn(f"{node.resolve('image')}: {picture.encoding}, {expected}", every=10.0)
        elif cameras and cameras[-1].matrix[0] > 0.0:
            scans.send(make_scan(depths, cameras[-1], settings, picture.stamp))

    def on_camera(camera: Calibration) -> None:
        cameras[:] = [camera]

    node.subscribe("image", Picture, on_picture)
    node.subscribe("camera_info", Calibration, on_camera)


def main() -> int:
    """Run the node."""
    return run("depthimage_to_laserscan", start)


if __name__ == "__main__":
    sys.exit(main())
