"""Parameters of fiducial mapping, with the names of fiducial_slam."""

from dataclasses import dataclass
from pathlib import Path

from ur.source.diagnostic import UserError, error
from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.parameters import Parameters
from ur_nodes.vision.detect import Sizes
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
        raise UserError(error(f"{source}: no fiducials in it, expected a map that was built before", rule="bad-map"))
    return FiducialSlam(settings.map_frame, sizes, FiducialLocaliser(known, spread_limit=settings.spread_limit), known)
