"""Colours of the map, for dark and for light rooms. Chosen to stay apart on 256 colours too."""

from __future__ import annotations

from dataclasses import dataclass

Colour = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Palette:
    """What is drawn in which colour (red, green, blue, 0 to 255)."""

    name: str
    unknown: Colour
    free: Colour
    wall: Colour
    scan: Colour
    path: Colour
    goal: Colour
    robot: Colour
    label: Colour
    ink: Colour  # on goal and robot


DARK = Palette(
    name="dark",
    unknown=(18, 18, 18),
    free=(38, 38, 38),
    wall=(188, 188, 188),
    scan=(215, 95, 95),
    path=(0, 95, 175),
    goal=(95, 215, 95),
    robot=(255, 215, 0),
    label=(215, 175, 255),
    ink=(18, 18, 18),
)
LIGHT = Palette(
    name="light",
    unknown=(208, 208, 208),
    free=(255, 255, 255),
    wall=(48, 48, 48),
    scan=(215, 95, 95),
    path=(135, 175, 255),
    goal=(0, 135, 0),
    robot=(215, 95, 0),
    label=(135, 0, 175),
    ink=(255, 255, 255),
)
