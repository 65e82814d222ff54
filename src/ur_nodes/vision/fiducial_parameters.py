"""Parameters of fiducial detection and mapping, with the names of aruco_detect and fiducial_slam."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ur_nodes.ports.parameters import Parameters
from ur_nodes.vision.detect import Sizes
from ur_nodes.vision.sizes import parse_numbers, parse_sizes


@dataclass(frozen=True, slots=True)
class SlamSettings:
    """Frames, and how tf is published: every `interval` s, dated `future` s ahead."""

    map_frame: str
    odom_frame: str
    base_frame: str
    publish_tf: bool
    interval: float
    future: float
    map_file: Path
    read_only: bool
    spread_limit: float


def read_slam_settings(own: Parameters) -> SlamSettings:
    """Read the frames, the map and the limits of fiducial_slam. Raises UserError."""
    return SlamSettings(
        own.text("map_frame", "map"),
        own.text("odom_frame", "odom"),
        own.text("base_frame", "base_footprint"),
        own.boolean("publish_tf", True),
        own.number("tf_publish_interval", 0.05, minimum=0.005, maximum=10.0),
        own.number("future_date_transforms", 0.1, minimum=0.0, maximum=10.0),
        Path(own.text("map_file", "~/.ros/slam/map.txt")).expanduser(),
        own.boolean("read_only_map", False),
        own.number("spread_limit", 1.0, minimum=0.1),
    )


def read_sizes(own: Parameters) -> Sizes:
    """`~fiducial_len`, `~fiducial_len_override`, `~ignore_fiducials`. Raises UserError."""
    usual = own.number("fiducial_len", 0.14, minimum=0.005, maximum=10.0)
    special, ignored = own.text("fiducial_len_override", ""), own.text("ignore_fiducials", "")
    try:
        sizes = parse_sizes(special)
    except ValueError:
        own.fail("fiducial_len_override", special, "numbers and sizes in m, such as '3: 0.2, 7-9: 0.1'")
        raise AssertionError from None
    try:
        return Sizes(usual, sizes, parse_numbers(ignored))
    except ValueError:
        own.fail("ignore_fiducials", ignored, "numbers, such as '3, 7-9'")
        raise AssertionError from None
