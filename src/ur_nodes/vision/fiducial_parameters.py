"""Parameters of the detection of fiducials and of their map, with the names of aruco_detect and fiducial_slam."""

from dataclasses import dataclass
from pathlib import Path

import cv2

from ur.source.diagnostic import user_error
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.parameters import Parameters
from ur_nodes.vision.detect import DICTIONARIES, Sizes
from ur_nodes.vision.estimation.localise import FiducialLocaliser
from ur_nodes.vision.estimation.mapping import FiducialMapper
from ur_nodes.vision.fiducial_map import read_map
from ur_nodes.vision.fiducial_slam import FiducialSlam


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


def make_slam(own: Parameters, settings: SlamSettings, sizes: Sizes) -> FiducialSlam:
    """Begin with the map that parameters name, or with the pose that they give. Raises UserError."""
    initial = own.text("initial_map_file", "")
    source = Path(initial).expanduser() if initial else settings.map_file
    known = read_map(source) if initial or settings.read_only or source.is_file() else ()
    place = Pose2(*(own.number(f"initial_pose_{axis}", 0.0) for axis in "xya"))
    if not settings.read_only:
        return FiducialSlam(settings.map_frame, sizes, FiducialMapper(known, start=None if known else place))
    if not known:
        raise user_error(f"{source}: no fiducials in it, expected a map that was built before", rule="bad-map")
    return FiducialSlam(settings.map_frame, sizes, FiducialLocaliser(known, spread_limit=settings.spread_limit), known)


@dataclass(frozen=True, slots=True)
class DetectSettings:
    """The fiducials to find; pictures to take, `raw` or compressed; what to publish beside the corners."""

    dictionary: str
    sizes: Sizes
    raw: bool
    estimate: bool
    publish_tf: bool
    draw: bool


def read_detect_settings(own: Parameters) -> DetectSettings:
    """Read the parameters of aruco_detect. Raises UserError."""
    return DetectSettings(
        read_dictionary(own),
        read_sizes(own),
        own.text("image_transport", "compressed", choices=("compressed", "raw")) == "raw",
        own.boolean("do_pose_estimation", True),
        own.boolean("publish_fiducial_tf", True),
        own.boolean("publish_images", True),
    )


def read_dictionary(own: Parameters) -> str:
    """`~dictionary`: a number of OpenCV's enumeration, as aruco_detect takes, or a name. Raises UserError."""
    value = own.any("dictionary", 7)
    names = {getattr(cv2.aruco, f"DICT_{name}"): name for name in DICTIONARIES}
    if isinstance(value, int) and not isinstance(value, bool):
        if value not in names:
            own.fail("dictionary", value, f"a number from 0 to {max(names)} or a name such as 5X5_1000")
        return names[value]
    return own.text("dictionary", choices=DICTIONARIES)


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


def parse_numbers(text: str) -> frozenset[int]:
    """Numbers and ranges, separated by commas. Raises ValueError."""
    found: set[int] = set()
    for part in filter(None, (each.strip() for each in text.split(","))):
        first, dash, last = part.partition("-")
        found.update(range(int(first), int(last if dash else first) + 1))
    return frozenset(found)


def parse_sizes(text: str) -> dict[int, float]:
    """Numbers or ranges, a colon, and the edge in m; separated by commas. Raises ValueError."""
    found: dict[int, float] = {}
    for part in filter(None, (each.strip() for each in text.split(","))):
        numbers, colon, size = part.partition(":")
        if not colon or not 0.0 < float(size) < 100.0:
            raise ValueError(f"{part!r} is not NUMBER: SIZE")
        found |= dict.fromkeys(parse_numbers(numbers), float(size))
    return found
