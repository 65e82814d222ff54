"""The parameters of the node `slam_gmapping`, under upstream's names (https://wiki.ros.org/gmapping), checked."""

import math
from dataclasses import dataclass

from ur.source.diagnostic import UserError, error
from ur_nodes.ports.parameters import Parameters
from ur_nodes.slam.mapper import MapperSettings

_EDGES = ("xmin", "ymin", "xmax", "ymax")


@dataclass(frozen=True, slots=True)
class GmappingSettings:
    """The node's parameters: lengths in m, times in s.

    `odom_frame` is '' without odometry. `max_range` is 0 for the scan's own limit, `max_usable` if all of that is
    drawn; `edges` (xmin, ymin, xmax, ymax) is the least size of the map; None: what was seen. `other_scans` are the
    topics of further lidars.
    """

    mapper: MapperSettings
    base_frame: str
    map_frame: str
    odom_frame: str
    throttle_scans: int
    map_update_interval: float
    max_range: float
    max_usable: float
    delta: float
    occ_thresh: float
    edges: tuple[float, float, float, float] | None
    transform_publish_period: float
    tf_delay: float
    other_scans: tuple[str, ...]


def read_settings(parameters: Parameters) -> GmappingSettings:
    """Read the settings of a node. Raises UserError, which names the parameter.

    Upstream's parameters of its particle filter and scan matcher have no meaning here, and are not read.
    """
    p = parameters
    period = p.number("transform_publish_period", 0.05, minimum=0.0)
    return GmappingSettings(
        mapper=MapperSettings(
            distance=p.number("linearUpdate", 0.4, minimum=0.05, maximum=1.0, live="way to the next keyframe, m"),
            turn=p.number("angularUpdate", 0.5, minimum=0.05, maximum=math.pi, live="turn to the next keyframe, rad"),
        ),
        base_frame=_frame(p, "base_frame", "base_link"),
        map_frame=_frame(p, "map_frame", "map"),
        odom_frame=_frame(p, "odom_frame", "odom"),
        throttle_scans=p.integer("throttle_scans", 1, minimum=1),
        map_update_interval=p.number("map_update_interval", 5.0, minimum=0.1, live="time between two maps, s"),
        max_range=p.number("maxRange", 0.0, minimum=0.0, live="range of the lidar that is used, m; 0: all of it"),
        max_usable=p.number("maxUrange", 0.0, minimum=0.0),
        delta=p.number("delta", 0.05, minimum=0.01, maximum=1.0),
        occ_thresh=p.number("occ_thresh", 0.25, minimum=0.0, maximum=1.0, live="share of hits that makes a wall"),
        edges=_edges(p),
        transform_publish_period=period,
        tf_delay=p.number("tf_delay", period, minimum=0.0),
        other_scans=tuple(p.text("other_scans", "").split()),
    )


def _edges(p: Parameters) -> tuple[float, float, float, float] | None:
    given = [name for name in _EDGES if p.has(name)]
    if not given:
        return None
    if len(given) < len(_EDGES):
        missing = ", ".join(f"~{name}" for name in _EDGES if name not in given)
        raise UserError(error(f"~{given[0]} is set, but not {missing}, expected all four", rule="bad-parameter"))
    left, low, right, high = (p.number(name) for name in _EDGES)
    if left >= right or low >= high:
        raise UserError(
            error(
                f"a map from ({left:g}, {low:g}) to ({right:g}, {high:g}), expected ~xmin < ~xmax, ~ymin < ~ymax",
                rule="bad-parameter",
            )
        )
    return left, low, right, high


def _frame(p: Parameters, name: str, default: str) -> str:
    return p.text(name, default).lstrip("/")  # tf1 wrote frames with a slash; tf2 refuses it
