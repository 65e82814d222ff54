"""The map on the screen: shows a snapshot, follows the robot, turns clicks into goals."""

import math
import time
from collections.abc import Mapping
from functools import lru_cache

from rich.segment import Segment
from rich.style import Style
from textual import events
from textual.geometry import Region
from textual.message import Message
from textual.strip import Strip
from textual.widget import Widget

from ur.tui.screen.half_blocks import Colour, Pixels, Run, cells_of_pixels
from ur_nodes.client.snapshot import GoalReport, LastGoalState, RobotSnapshot, heading_there
from ur_nodes.geometry.grid import Grid
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.glyphs import draw_glyphs, scale_bar
from ur_nodes.teleop.map_view.palette import MapPalette
from ur_nodes.teleop.map_view.picture import (
    GridIndex,
    Viewport,
    draw_map,
    draw_overlay,
    fit_viewport,
    index_grid,
    pan_viewport,
    resize_viewport,
    zoom_viewport,
)

_NO_MAP_BOX = (-5.0, -5.0, 5.0, 5.0)
_FOLLOW_MARGIN = 0.3  # of the screen: the picture moves only when the robot comes this near to the edge
_LEAST_DRAG = 2.0  # pixels, half a row each: a shorter drag is a click, without a heading
_FOLLOW_SCALE = 0.08  # m per pixel: following starts at least this close


class MapView(Widget, can_focus=False):
    """Half-block picture of a `RobotSnapshot`. Click: goal; drag: goal with heading; right drag: pan; wheel: zoom."""

    DEFAULT_CSS = "MapView { width: 1fr; height: 1fr; }"

    double_click = 0.5  # s between the presses of a double click, at the most

    class GoalPicked(Message):
        """The user has chosen a goal with the mouse; `any_heading` for a click, which has no heading."""

        def __init__(self, pose: Pose2, *, any_heading: bool) -> None:
            super().__init__()
            self.place, self.any_heading = pose, any_heading

    class ViewChanged(Message):
        """The scale, the position or the following of the robot has changed."""

    def __init__(self, palette: MapPalette, *, id: str | None = None) -> None:
        super().__init__(id=id)
        self.palette = palette
        self.following = False
        self.view = Viewport(0.0, 0.0, 0.05, 0, 0)
        self.hover: tuple[float, float] | None = None
        self._fitted = True  # until the user zooms or pans, the whole map is shown at any size
        self._snapshot = RobotSnapshot()
        self._places: Mapping[str, Pose2] = {}
        self._index: GridIndex | None = None
        self._base: tuple[Viewport, MapPalette, GridIndex | None, Pixels] | None = None
        self._lines: list[tuple[Run, ...]] = []
        self._pressed: tuple[int, int, int] | None = None  # button, column, row
        self._dragged_to: tuple[int, int] | None = None
        self._released: tuple[float, tuple[int, int] | None] = (-math.inf, None)  # when, and where if it matters

    def ignore_double_click(self) -> None:
        """Ignore the second press of a double click whose first one closed a panel above the map."""
        self._released = (time.monotonic(), None)

    def show(self, snapshot: RobotSnapshot, places: Mapping[str, Pose2]) -> None:
        """Show another snapshot; only lines that differ are drawn again."""
        if snapshot.grid is not self._snapshot.grid:
            self._index = index_grid(snapshot.grid) if snapshot.grid is not None else None
            self._fit_if(self._fitted, snapshot.grid)
        self._snapshot, self._places = snapshot, places
        self._keep_robot_in_view()
        self.redraw()

    def set_palette(self, palette: MapPalette) -> None:
        """Change the colours."""
        self.palette = palette
        self.redraw()

    def fit(self) -> None:
        """Show the whole map."""
        self.following = False
        self._fit_if(True, self._snapshot.grid)
        self.redraw()

    def zoom(self, factor: float, column: float | None = None, row: float | None = None) -> None:
        """Zoom about a pixel, by default the middle of the view (the robot when it is followed)."""
        self._fitted = False
        if self.following and self._snapshot.pose is not None:
            column, row = self.view.to_pixel(self._snapshot.pose.x, self._snapshot.pose.y)
        self.view = zoom_viewport(self.view, factor, column, row)
        self._keep_robot_in_view()
        self.redraw()

    def pan(self, columns: float, rows: float) -> None:
        """Move the view right and down, in fractions of the screen, and stop following the robot."""
        self._move(columns * self.view.width, rows * self.view.height)

    def toggle_follow(self) -> bool:
        """Start or stop following the robot; return whether it is followed now."""
        self.following = not self.following
        pose = self._snapshot.pose
        if self.following and pose is not None:
            self._fitted = False
            scale = min(self.view.scale, _FOLLOW_SCALE)
            self.view = Viewport(pose.x, pose.y, scale, self.view.width, self.view.height)
        self.redraw()
        self.post_message(self.ViewChanged())
        return self.following

    def redraw(self) -> None:
        """Draw the map, and refresh the lines that changed."""
        if not self.view.width or not self.view.height:
            return
        key = (self.view, self.palette, self._index)
        if self._base is None or self._base[:3] != key:
            self._base = (*key, draw_map(self._index, self.view, self.palette))
            self.post_message(self.ViewChanged())
        picture = draw_overlay(self._base[3], self._snapshot, self.view, self.palette)
        glyphs = draw_glyphs(self._snapshot, self._places, self._preview(), self.view, self.palette)
        glyphs += scale_bar(self.view, self.palette)
        lines = cells_of_pixels(picture, glyphs)
        old = self._lines
        self._lines = lines
        if len(old) != len(lines):
            self.refresh()
            return
        changed = [Region(0, y, self.size.width, 1) for y, line in enumerate(lines) if line != old[y]]
        if changed:
            self.refresh(*changed)

    def render_line(self, y: int) -> Strip:
        """Return a line of the widget."""
        if y >= len(self._lines):
            return Strip([Segment(" " * self.size.width, Style.null())])  # Textual's filters take no None
        segments = [Segment(text, _style(fore, back)) for text, fore, back in self._lines[y]]
        return Strip(segments).adjust_cell_length(self.size.width, Style.null())

    def on_resize(self, event: events.Resize) -> None:
        """Keep position and scale at the new size; fit the map again if all of it was shown."""
        self.view = resize_viewport(self.view, event.size.width, event.size.height * 2)
        self._fit_if(self._fitted, self._snapshot.grid)
        self._keep_robot_in_view()
        self.redraw()

    def on_mouse_down(self, event: events.MouseDown) -> None:
        """Begin a click or a drag, except by the second press of a double click."""
        released_at, where = self._released
        if event.time - released_at < self.double_click and where in (None, (event.x, event.y)):
            return
        self._pressed = (3 if event.shift else event.button, event.x, event.y)
        self._dragged_to = None
        self.capture_mouse()

    def on_mouse_move(self, event: events.MouseMove) -> None:
        """Show the position of the mouse, and continue a drag."""
        self.hover = self.view.to_map(event.x + 0.5, event.y * 2 + 1.0)
        if self._pressed is None:
            return
        button, column, row = self._pressed
        if button == 1:
            long = math.hypot(event.x - column, 2.0 * (event.y - row)) >= _LEAST_DRAG
            self._dragged_to = (event.x, event.y) if long else None
            self.redraw()
        else:
            self._pressed = (button, event.x, event.y)
            self._move(column - event.x, 2.0 * (row - event.y))

    def on_mouse_up(self, event: events.MouseUp) -> None:
        """End the click or drag; the left button sets a goal."""
        self.release_mouse()
        if self._pressed is not None:
            self._released = (event.time, (event.x, event.y))
        if self._pressed is not None and self._pressed[0] == 1:
            if (event.x, event.y) == self._pressed[1:]:
                self._dragged_to = None
            goal = self._preview()
            if goal is not None and goal.pose is not None:
                self.post_message(self.GoalPicked(goal.pose, any_heading=goal.any_heading))
        self._pressed = self._dragged_to = None
        self.redraw()

    def on_leave(self, _event: events.Leave) -> None:
        """Hide the position of the mouse, which has left the map."""
        self.hover = None

    def on_mouse_scroll_up(self, event: events.MouseScrollUp) -> None:
        """Zoom in about the mouse."""
        self.zoom(1.25, event.x + 0.5, event.y * 2 + 1.0)

    def on_mouse_scroll_down(self, event: events.MouseScrollDown) -> None:
        """Zoom out about the mouse."""
        self.zoom(0.8, event.x + 0.5, event.y * 2 + 1.0)

    def _preview(self) -> GoalReport | None:
        """Return the goal that releasing the button would set."""
        if self._pressed is None or self._pressed[0] != 1:
            return None
        _, column, row = self._pressed
        x, y = self.view.to_map(column + 0.5, row * 2 + 1.0)
        if self._dragged_to is None:
            place = Pose2(x, y, heading_there(self._snapshot.pose, x, y))
            return GoalReport(pose=place, state=LastGoalState.WAITING, any_heading=True)
        to_column, to_row = self._dragged_to
        place = Pose2(x, y, math.atan2(2.0 * (row - to_row), to_column - column))
        return GoalReport(pose=place, state=LastGoalState.WAITING)

    def _move(self, columns: float, rows: float) -> None:
        self.following = self._fitted = False
        self.view = pan_viewport(self.view, columns, rows)
        self.redraw()

    def _fit_if(self, wanted: bool, grid: Grid | None) -> None:
        if not wanted:
            return
        self._fitted = True
        bounds = grid.bounds if grid is not None else _NO_MAP_BOX
        self.view = fit_viewport(bounds, self.view.width, self.view.height)

    def _keep_robot_in_view(self) -> None:
        pose = self._snapshot.pose
        if not self.following or pose is None:
            return
        column, row = self.view.to_pixel(pose.x, pose.y)
        width, height = self.view.width, self.view.height
        if not (
            _FOLLOW_MARGIN * width < column < (1 - _FOLLOW_MARGIN) * width
            and _FOLLOW_MARGIN * height < row < (1 - _FOLLOW_MARGIN) * height
        ):
            self.view = Viewport(pose.x, pose.y, self.view.scale, width, height)


@lru_cache(maxsize=4096)
def _style(fore: Colour, back: Colour) -> Style:
    return Style.parse(f"rgb({fore[0]},{fore[1]},{fore[2]}) on rgb({back[0]},{back[1]},{back[2]})")
