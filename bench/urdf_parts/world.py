"""The world that a base fits into."""

from __future__ import annotations

from collections.abc import Mapping

from bench.navigation_parts.stack import ROOT

from ur.robot.base import load_base
from ur.robot.base.search import find_base_package
from ur_nodes.costmap.footprint import footprint_of_outline

_DOOR = 0.45  # m, half the width of the doors of both worlds; the maze has a door every few metres


def choose_world(name: str, environment: Mapping[str, str]) -> str:
    """The maze; the office for a base that cannot turn in a door."""
    base = load_base(find_base_package(ROOT / "ubiquity_launches", name, environment), name)
    return "maze" if footprint_of_outline(base.footprint, 0.05).circumscribed <= _DOOR else "office"
