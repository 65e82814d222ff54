"""The parameters of the local costmap, and of the robot's footprint, under upstream's names."""

from dataclasses import dataclass

from ur.source.diagnostic import user_error
from ur_nodes.costmap.costmap import Inflation
from ur_nodes.costmap.footprint import Footprint, footprint_of_outline, footprint_of_radius
from ur_nodes.costmap.layers import UsedRanges
from ur_nodes.costmap.touched import BumperSource, read_bumpers
from ur_nodes.ports.parameters import Parameters


def read_footprint(part: Parameters, resolution: float) -> Footprint:
    """Read the outline of the robot, or its radius. `resolution` is in m per cell. Raises UserError."""
    padding = part.number("footprint_padding", 0.01, minimum=0.0)
    points = part.points("footprint", ())
    if not points:
        return footprint_of_radius(part.number("robot_radius", 0.25, minimum=0.02), resolution, padding)
    try:
        return footprint_of_outline(points, resolution, padding)
    except ValueError as problem:
        raise user_error(
            f"parameter footprint: {problem}, expected at least three corners, in order, round the base's origin",
            rule="bad-parameter",
        ) from None


@dataclass(frozen=True, slots=True)
class LocalCostmapSettings:
    """The parameters below `~costmap`; lengths in m, frequencies in Hz."""

    frame: str
    base_frame: str
    footprint: Footprint
    side: float
    resolution: float
    reach: UsedRanges
    inf_is_valid: bool
    inflation: Inflation
    scan: str
    sonars: tuple[str, ...]
    bumpers: tuple[BumperSource, ...]
    update_frequency: float
    publish_frequency: float


def read_settings(own: Parameters) -> LocalCostmapSettings:
    """Read them. Raises UserError, which names the parameter."""
    resolution = own.number("resolution", 0.05, minimum=0.005, maximum=1.0)
    footprint = read_footprint(own, resolution)
    obstacles, slopes, sonars = own.below("obstacle_layer"), own.below("inflation_layer"), own.below("sonar_layer")
    sources = obstacles.text("observation_sources", "").split()
    if len(sources) > 1:
        obstacles.fail("observation_sources", " ".join(sources), "one name at most: this node looks at one laser")
    source = obstacles.below(sources[0] if sources else "scan")
    return LocalCostmapSettings(
        frame=own.text("global_frame", "odom"),
        base_frame=own.text("robot_base_frame", "base_footprint"),
        footprint=footprint,
        side=max(own.number("width", 4.0, minimum=1.0), own.number("height", 4.0, minimum=1.0)),
        resolution=resolution,
        reach=UsedRanges(
            source.number("obstacle_range", 2.5, minimum=0.1), source.number("raytrace_range", 3.0, minimum=0.1)
        ),
        inf_is_valid=source.boolean("inf_is_valid", False),
        inflation=Inflation(
            footprint.inscribed,
            slopes.number("inflation_radius", 0.55, minimum=0.0),
            slopes.number("cost_scaling_factor", 10.0, minimum=0.1),
        ),
        scan=source.text("topic", sources[0]) if sources else "",
        sonars=sonars.texts("topics", ()),
        bumpers=read_bumpers(own.below("bumper_layer")),
        update_frequency=own.number("update_frequency", 5.0, minimum=0.1, maximum=50.0),
        publish_frequency=own.number("publish_frequency", 2.0, minimum=0.1, maximum=50.0),
    )
