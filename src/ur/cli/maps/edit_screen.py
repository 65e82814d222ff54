"""The screen of `ur maps edit`: the map, a cursor that keys and mouse move, marked points, and one line of messages."""

from __future__ import annotations

import os
from collections.abc import Callable

import numpy as np
from rich.segment import Segment
from rich.style import Style
from rich.text import Text
from textual import events
from textual.app import ComposeResult
from textual.strip import Strip
from textual.widget import Widget
from textual.widgets import Input, Static

from ur.maps.drawing import FREE_PIXEL, WALL_PIXEL, sample_pixels
from ur.maps.editing import EditSession
from ur.maps.record import Zone
from ur.maps.viewport import Viewport, fit_viewport, show_point, zoom_viewport
from ur.source.diagnostic import UserError
from ur.tui.screen.app import FullScreenApp
from ur.tui.screen.query import ask_background, is_light
from ur.worlds.map_file import MapImage

_HELP = (
    "arrows, Shift: move   Space: mark   w: wall   e: erase   k: keep out   s: slow   x: delete zone   "
    "p: name a place   r: walls along the axes   o: origin here   u: undo   + - 0: zoom   Esc: forget marks   q: quit"
)
_FAST = 8  # pixels, with Shift
_DARK = {WALL_PIXEL: "#d0d0d0", FREE_PIXEL: "#303030"}, "#121212"
_LIGHT = {WALL_PIXEL: "#202020", FREE_PIXEL: "#ffffff"}, "#b8b8b8"
_CURSOR, _MARK, _PLACE = "#ffd700", "#ff5f5f", "#d7afff"
_ZONES = {"keep-out": "#e03131", "speed": "#e8a50a"}
_SLOW = 50  # percent


class MapCanvas(Widget, can_focus=False):
    """Half-block picture of a map with a cursor (m), marked points and named places."""

    DEFAULT_CSS = "MapCanvas { width: 1fr; height: 1fr; }"

    def __init__(self, session: EditSession, *, light: bool) -> None:
        super().__init__()
        self._session = session
        self._colours, self._unknown = _LIGHT if light else _DARK
        self._image: MapImage = session.image()
        self._places, self._zones = session.places(), session.zones()
        self._strips: list[Strip] = []
        self.view: Viewport | None = None
        left, bottom, right, top = self._image.bounds
        self.cursor = ((left + right) / 2, (bottom + top) / 2)

    def read(self) -> None:
        """Read the map again after a change."""
        self._image, self._places, self._zones = self._session.image(), self._session.places(), self._session.zones()
        self.draw()

    def fit(self) -> None:
        """Show the whole map."""
        self.view = fit_viewport(self._image.bounds, self.size.width, 2 * self.size.height)
        self.draw()

    def zoom(self, factor: float) -> None:
        """Zoom about the cursor."""
        if self.view:
            self.view = zoom_viewport(self.view, factor, *self.view.to_pixel(*self.cursor))
            self.draw()

    def move(self, columns: int, rows: int) -> None:
        """Move the cursor by pixels, right and down; the view follows it."""
        if self.view:
            x, y = self.cursor
            self.cursor = (x + columns * self.view.scale, y - rows * self.view.scale)
            self.view = show_point(self.view, *self.cursor)
            self.draw()

    def on_resize(self) -> None:
        """Show the whole map at the new size."""
        self.fit()

    def on_click(self, event: events.Click) -> None:
        """Move the cursor to the mouse position."""
        if self.view:
            self.cursor = self.view.to_map(event.x + 0.5, 2 * event.y + 1.0)
            self.draw()

    def draw(self) -> None:
        """Draw map, marks, places and cursor."""
        view = self.view
        if view is None or not view.width or not view.height:
            return
        pixels = sample_pixels(self._image, view)
        over: dict[tuple[int, int], tuple[str, str]] = {}
        for zone in self._zones:
            self._outline(zone, view, over)
        for title, (x, y, _) in self._places.items():
            column, row = view.to_pixel(x, y)
            for offset, letter in enumerate(f"•{title}"):
                over[int(row) // 2, int(column) + offset] = (letter, _PLACE)
        for x, y in self._session.marks:
            column, row = view.to_pixel(x, y)
            over[int(row) // 2, int(column)] = ("×", _MARK)  # noqa: RUF001 - a mark
        column, row = view.to_pixel(*self.cursor)
        over[int(row) // 2, int(column)] = ("┼", _CURSOR)
        self._strips = [self._strip(pixels[2 * line : 2 * line + 2], line, over) for line in range(view.height // 2)]
        self.refresh()

    def render_line(self, y: int) -> Strip:
        """Return a line of the widget."""
        if y >= len(self._strips):
            return Strip([Segment(" " * self.size.width, Style.null())])
        return self._strips[y]

    def _outline(self, zone: Zone, view: Viewport, over: dict[tuple[int, int], tuple[str, str]]) -> None:
        """Draw the edge and the name of a zone."""
        colour = _ZONES[zone.kind]
        corners = np.array([view.to_pixel(*point) for point in zone.points])
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            steps = min(4 * (view.width + view.height), int(np.abs(end - start).max()) + 2)
            for column, row in (start + np.linspace(0.0, 1.0, steps)[:, None] * (end - start)).tolist():
                over[int(row) // 2, int(column)] = ("▒", colour)
        text = zone.name if zone.kind == "keep-out" else f"{zone.name} {zone.percent} %"
        column, row = corners.mean(axis=0).tolist()
        for offset, letter in enumerate(text):
            over[int(row) // 2, int(column) - len(text) // 2 + offset] = (letter, colour)

    def _strip(self, pair: np.ndarray, line: int, over: dict[tuple[int, int], tuple[str, str]]) -> Strip:
        segments = []
        for column, (upper, lower) in enumerate(pair.T.tolist()):
            above, below = (self._colours.get(each, self._unknown) for each in (upper, lower))
            letter, colour = over.get((line, column), (" " if above == below else "▀", above))
            segments.append(Segment(letter, Style(color=colour, bgcolor=below)))
        return Strip(Segment.simplify(segments))


class EditApp(FullScreenApp[None]):
    """The editor, which handles keys. Every change is stored at once."""

    CSS = """
    #head { height: 1; background: $primary; color: $text; padding: 0 1; }
    #message { height: 1; padding: 0 1; }
    #help { height: auto; max-height: 3; color: $text-muted; padding: 0 1; }
    #name { height: 1; border: none; padding: 0 1; display: none; }
    """
    AUTO_FOCUS = None  # keys belong to the map until a name is asked for

    def __init__(self, session: EditSession, *, light: bool = False) -> None:
        super().__init__()
        self.session = session
        self._light = light
        self.canvas = MapCanvas(session, light=light)

    def compose(self) -> ComposeResult:
        """Arrange header, map, message, the input for the name of a place, and help."""
        yield Static(id="head")
        yield self.canvas
        yield Static(id="message")
        yield Input(placeholder="the name of the place at the cursor, then Enter; Esc: none", id="name", compact=True)
        yield Static(_HELP, id="help")

    def on_mount(self) -> None:
        """Set the colours and show the cursor."""
        self.use_theme(light=self._light)
        self._show("")

    def on_key(self, event: events.Key) -> None:
        """Handle a key, unless a name is being typed."""
        name = self.query_one("#name", Input)
        if name.display:
            if event.key == "escape":
                self._end_name()
            return
        event.prevent_default()
        action = _ACTIONS.get(event.key)
        if event.key in ("q", "ctrl+c", "ctrl+q"):
            self.exit()
        elif event.key == "p":
            name.display = True
            name.focus()
        elif event.key in _MOVES:
            self.canvas.move(*_MOVES[event.key])
            self._show("")
        elif action is not None:
            self._try(action)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Name the place at the cursor."""
        title = event.value.strip()
        self._end_name()
        if title:
            self._try(lambda app: app.session.place(title, *app.canvas.cursor))

    def _end_name(self) -> None:
        name = self.query_one("#name", Input)
        name.value, name.display = "", False
        self.set_focus(None)

    def _try(self, action: Callable[[EditApp], str]) -> None:
        try:
            text, style = action(self), ""
        except UserError as problem:
            text, style = problem.diagnostics[0].message, "bold red"
        except OSError as problem:
            reason = (problem.strerror or str(problem)).lower()
            text, style = f"'{problem.filename}' cannot be written: {reason}", "bold red"
        try:
            self.canvas.read()
        except UserError as problem:
            text, style = problem.diagnostics[0].message, "bold red"
        self._show(text, style)

    def _show(self, text: str, style: str = "") -> None:
        x, y = self.canvas.cursor
        marks = len(self.session.marks)
        head = f"{self.session.name}   cursor {x:.2f} {y:.2f} m" + (f"   {marks} marked" if marks else "")
        self.query_one("#head", Static).update(Text(head))
        self.query_one("#message", Static).update(Text(text, style))


def run_editor(session: EditSession) -> int:
    """Show the screen until the user leaves it; return the exit code."""
    app = EditApp(session, light=is_light(os.environ, ask_background(0, 1)))
    app.run()
    if app.problem is not None:
        raise app.problem
    return app.return_code or 0


def _mark(app: EditApp) -> str:
    app.session.mark(*app.canvas.cursor)
    return "marked; w: wall, e: erase, k: keep out, s: slow"


def _clear(app: EditApp) -> str:
    app.session.clear()
    return ""


def _zoom(factor: float) -> Callable[[EditApp], str]:
    def zoom(app: EditApp) -> str:
        app.canvas.zoom(factor)
        return ""

    return zoom


def _fit(app: EditApp) -> str:
    app.canvas.fit()
    return ""


_MOVES = {
    f"{prefix}{key}": (columns * far, rows * far)
    for key, columns, rows in (("left", -1, 0), ("right", 1, 0), ("up", 0, -1), ("down", 0, 1))
    for prefix, far in (("", 1), ("shift+", _FAST))
}
_ACTIONS: dict[str, Callable[[EditApp], str]] = {
    "space": _mark,
    "enter": _mark,
    "escape": _clear,
    "w": lambda app: app.session.draw("wall"),
    "e": lambda app: app.session.draw("erase"),
    "k": lambda app: app.session.zone("keep-out"),
    "s": lambda app: app.session.zone("speed", _SLOW),
    "x": lambda app: app.session.delete_zone(*app.canvas.cursor),
    "r": lambda app: app.session.rotate(),
    "o": lambda app: app.session.set_origin(*app.canvas.cursor),
    "u": lambda app: app.session.undo(),
    **dict.fromkeys(("plus", "equals_sign"), _zoom(1.5)),
    "minus": _zoom(1 / 1.5),
    "0": _fit,
}
