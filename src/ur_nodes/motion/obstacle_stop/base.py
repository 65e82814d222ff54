"""The obstacle stop of a base from its file: its initial sight, and the points that its contact sensors cover."""

from __future__ import annotations

from ur.robot.base import Base
from ur.source.printable import printable
from ur_nodes.geometry.hull import Floats, Hull, hull_of_outline
from ur_nodes.motion.obstacle_stop.guard import reach_of
from ur_nodes.motion.obstacle_stop.sensors import sensors_of
from ur_nodes.motion.obstacle_stop.sight import Contact, Sight

_LONGEST = 80  # characters
_SPREAD = 0.5  # rad to either side of the direction of a cliff sensor


def make_sight(base: Base, *, sonars: bool = True) -> Sight:
    """Return the sight of a base before any reading; `sonars`: it has those of its file."""
    hull = hull_of_outline(base.footprint)
    return Sight(hull, sensors_of(base, hull, sonars=sonars), reach_of(hull, base.limits))


def contact_points(base: Base, hull: Hull, contact: tuple[Contact, str]) -> Floats:
    """The points of the outline (n, 2) in the base's frame that a bumper or a cliff sensor of the base covers."""
    kind, name = contact
    if kind == "cliff":
        directions = {} if base.cliffs is None else {cliff.name: cliff.direction for cliff in base.cliffs.at}
        return hull.edge_points(directions[name] - _SPREAD, directions[name] + _SPREAD)
    at = {} if base.bumpers is None else {bumper.name: bumper for bumper in base.bumpers.at}
    return hull.edge_points(at[name].start, at[name].end)


def contact_topics(base: Base) -> dict[tuple[Contact, str], str]:
    """The topic of each bumper and of each cliff sensor of the base."""
    topics: dict[tuple[Contact, str], str] = {}
    if base.bumpers:
        topics |= {("bumper", each.name): f"{base.bumpers.topic}/{each.name}" for each in base.bumpers.at}
    if base.cliffs:
        topics |= {("cliff", each.name): f"{base.cliffs.topic}/{each.name}" for each in base.cliffs.at}
    return topics


def explain_frame(base: Base, frame: str) -> str:
    """Return the warning about ranges in a frame of no sonar of the base; empty if the frame is one of them."""
    known = [sonar.frame for sonar in base.sonars.at] if base.sonars else []
    if frame in known:
        return ""
    expected = f"expected a sonar of the base file: {', '.join(known)}"
    return f"the obstacle stop ignores ranges of '{printable(frame)[:_LONGEST]}', {expected}"
