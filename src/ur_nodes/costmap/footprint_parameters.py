"""The footprint of a robot, from the parameters of a costmap."""

from __future__ import annotations

from ur.source.diagnostic import UserError, error
from ur_nodes.costmap.footprint import Footprint, footprint_of_outline, footprint_of_radius
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
        raise UserError(
            error(
                f"parameter footprint: {problem}, expected at least three corners, in order, round the base's origin",
                rule="bad-parameter",
            )
        ) from None
