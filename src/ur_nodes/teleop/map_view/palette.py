"""Colours of the map, dark and light, which differ on terminals of 256 colours, too."""

from dataclasses import dataclass

from ur.tui.screen.half_blocks import Colour


@dataclass(frozen=True, slots=True)
class MapPalette:
    """The colour of each thing on the map (red, green, blue, 0 to 255)."""

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
    few_colours: bool = False  # then nothing is shaded


DARK = MapPalette(
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
LIGHT = MapPalette(
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

# Exactly those of Textual's and the console's 16: what lies between would become black, walls too.
DARK_16 = MapPalette(
    name="dark",
    unknown=(85, 85, 85),
    free=(0, 0, 0),
    wall=(170, 170, 170),
    scan=(170, 0, 0),
    path=(0, 0, 170),
    goal=(0, 170, 0),
    robot=(170, 85, 0),
    label=(170, 0, 170),
    ink=(0, 0, 0),
    few_colours=True,
)
LIGHT_16 = MapPalette(
    name="light",
    unknown=(170, 170, 170),
    free=(255, 255, 255),
    wall=(0, 0, 0),
    scan=(170, 0, 0),
    path=(0, 170, 170),
    goal=(0, 170, 0),
    robot=(0, 0, 170),
    label=(170, 0, 170),
    ink=(255, 255, 255),
    few_colours=True,
)


def choose_palette(*, light: bool, few_colours: bool) -> MapPalette:
    """Return the palette for a light or dark background, or for terminals of 16 colours."""
    if few_colours:
        return LIGHT_16 if light else DARK_16
    return LIGHT if light else DARK
