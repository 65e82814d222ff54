"""The world that a base fits into."""

from collections.abc import Mapping

from bench.navigation_parts.stack import ROOT

from ur.robot.base import load_base
from ur.robot.base.files import find_base_package
from ur_nodes.costmap.footprint import footprint_of_outline

_DOOR = 0.45  # m, half the width of the doors of both worlds; the maze has a door every few metres
_STEP = 0.05  # m between points of the outline: radii do not depend on it


def choose_world(name: str, environment: Mapping[str, str]) -> str:
    """The world for a base by name. Raises UserError: there is none."""
    return world_for(load_base(find_base_package(ROOT / "ubiquity_launches", name, environment), name).footprint)


def world_for(outline: tuple[tuple[float, float], ...]) -> str:
    """The maze; the office for an outline that cannot turn in a door, whose farthest corner is above 0.45 m away."""
    return "maze" if footprint_of_outline(outline, _STEP).circumscribed <= _DOOR else "office"
