"""Characters over the map: waypoints, goal, robot, and the scale bar. Pure."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from ur.tui.screen.half_blocks import Colour, Glyph
from ur_nodes.client.snapshot import GoalReport, RobotSnapshot
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.palette import MapPalette
from ur_nodes.teleop.map_view.picture import ROBOT_LENGTH, SMALL_ROBOT, Viewport

_ARROWS = "→↗↑↖←↙↓↘"
_NO_HEADING = "◎"
_LEAST_BAR, _MOST_BAR = 5, 0.25  # columns; of the map's width

Cell = tuple[int, int]
"""Column and row."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A character at a point of the map (m); `blocked` if the robot cannot reach the point."""

    x: float
    y: float
    text: str
    blocked: bool = False


def draw_marks(marks: Sequence[Mark], view: Viewport, palette: MapPalette) -> list[Glyph]:
    """Return the marks that lie in the view."""
    found = ((mark, _cell(view, Pose2(mark.x, mark.y, 0.0))) for mark in marks)
    return [Glyph(*cell, m.text, palette.scan if m.blocked else palette.label) for m, cell in found if cell]


def draw_glyphs(
    snapshot: RobotSnapshot,
    places: Mapping[str, Pose2],
    preview: GoalReport | None,
    view: Viewport,
    palette: MapPalette,
) -> list[Glyph]:
    """Return characters to draw over the pixels; later ones cover earlier ones. `preview` replaces the goal.

    Names of waypoints are beside what they would cover: the robot, the goal, other names. A name for which there
    is no room is left out; its dot stays.
    """
    marks = []
    goal = preview or snapshot.goal
    if goal.pose is not None and not goal.over:
        sign = _NO_HEADING if goal.any_heading else _arrow_of(goal.pose.yaw)
        marks += _mark(view, goal.pose, sign, palette.ink, palette.goal)
    if snapshot.pose is not None and ROBOT_LENGTH / view.scale < SMALL_ROBOT:
        marks += _mark(view, snapshot.pose, _arrow_of(snapshot.pose.yaw), palette.ink, palette.robot)
    taken = {(mark.column, mark.row) for mark in marks} | _robot_cells(snapshot.pose, view)
    dots = {name: cell for name, place in places.items() if (cell := _cell(view, place))}
    blocked = taken | set(dots.values())
    glyphs = [Glyph(*cell, "•", palette.label) for cell in dots.values() if cell not in taken]
    for name, dot in dots.items():
        for column, row in _spots(name, dot, taken, view):
            cells = {(column + i, row) for i in range(len(name))}
            if not cells & blocked and all(_inside(view, cell) for cell in cells):
                blocked |= cells
                glyphs += [Glyph(column + i, row, letter, palette.label) for i, letter in enumerate(name)]
                break
    return glyphs + marks


def scale_bar(view: Viewport, palette: MapPalette) -> list[Glyph]:
    """Return a bar of 1, 2 or 5 times a power of ten metres for the lower left corner; none if it does not fit."""
    rows = view.height // 2
    for power in range(-2, 4):
        for digit in (1, 2, 5):
            length = digit * 10.0**power
            columns = round(length / view.scale)
            if columns >= _LEAST_BAR:
                if columns > max(_LEAST_BAR * 3, view.width * _MOST_BAR) or rows < 4:
                    return []
                text = f"├{'─' * (columns - 2)}┤ {length:g} m"
                return [Glyph(1 + i, rows - 1, char, palette.label) for i, char in enumerate(text[: view.width - 2])]
    return []


def _spots(name: str, dot: Cell, taken: set[Cell], view: Viewport) -> Iterator[Cell]:
    """Yield the cells where a name may begin, best first: right of the dot (or its cover), left, above, below."""
    column, row = dot
    right = column + 1
    while (right, row) in taken and right < view.width:
        right += 1
    left = column
    while (left - 1, row) in taken and left > 0:
        left -= 1
    gap = 1 if dot in taken else 0
    yield right + gap, row
    yield left - gap - len(name), row
    for distance in (1, 2, 3):
        for sign in (-1, 1):
            yield max(0, min(column - len(name) // 2, view.width - len(name))), row + sign * distance


def _robot_cells(pose: Pose2 | None, view: Viewport) -> set[Cell]:
    """Return the cells of a robot that is drawn to scale."""
    size = ROBOT_LENGTH / view.scale
    if pose is None or size < SMALL_ROBOT:
        return set()
    column, row = view.to_pixel(pose.x, pose.y)
    columns = range(math.floor(column - size / 2), math.floor(column + size / 2) + 1)
    rows = range(math.floor((row - size / 2) / 2), math.floor((row + size / 2) / 2) + 1)
    return {(x, y) for x in columns for y in rows}


def _arrow_of(yaw: float) -> str:
    return _ARROWS[round(yaw / (math.pi / 4)) % 8]


def _inside(view: Viewport, cell: Cell) -> bool:
    return 0 <= cell[0] < view.width and 0 <= cell[1] < view.height // 2


def _cell(view: Viewport, pose: Pose2) -> Cell | None:
    column, row = view.to_pixel(pose.x, pose.y)
    cell = math.floor(column), math.floor(row / 2)
    return cell if _inside(view, cell) else None


def _mark(view: Viewport, pose: Pose2, text: str, colour: Colour, behind: Colour) -> list[Glyph]:
    cell = _cell(view, pose)
    return [Glyph(*cell, text, colour, behind)] if cell else []
