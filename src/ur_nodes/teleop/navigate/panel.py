"""A box of text over the map, and the list of waypoints for one."""

from collections.abc import Callable, Mapping

from rich.console import RenderableType
from rich.measure import Measurement
from rich.table import Table
from rich.text import Text
from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import Static

from ur_nodes.client.snapshot import format_pose
from ur_nodes.geometry.pose import Pose2

_WIDEST = 200
_FRAME = 5  # columns: border, padding, scroll bar
_SCROLL_KEYS = frozenset({"up", "down", "pageup", "pagedown", "home", "end"})


class Panel(VerticalScroll, can_focus=False):
    """A box of text over the map. A click closes it, and so does every key except those that scroll a long text.

    A letter or digit that closes it also begins a command.

    It is no screen of its own: all keys go to the command line, which asks `press_key` first.
    """

    DEFAULT_CSS = """
    Panel { layer: above; display: none; height: auto; max-width: 100%; max-height: 100%;
            border: round $primary; padding: 0 1; background: $surface; scrollbar-size-vertical: 1; }
    Panel Static { width: 1fr; height: auto; }
    """

    def __init__(self, on_click_close: Callable[[], None], *, id: str | None = None) -> None:
        super().__init__(id=id)
        self._on_click_close = on_click_close

    def compose(self) -> ComposeResult:
        """Lay out the text."""
        yield Static(id="text")

    @property
    def is_open(self) -> bool:
        """True while it is on the screen."""
        return bool(self.display)

    def open(self, title: str, text: RenderableType) -> None:
        """Show a text from its beginning, in place of the present one."""
        self.query_one(Static).update(text)
        wide = self.app.console.options.update(max_width=_WIDEST)
        self.styles.width = Measurement.get(self.app.console, wide, text).maximum + _FRAME
        self.border_title = title
        self.border_subtitle = "any key closes this"
        self.display = True
        self.scroll_home(animate=False)
        self.call_after_refresh(self._describe_keys)

    def close(self) -> None:
        """Hide the panel; a second call has no effect."""
        self.display = False

    def press_key(self, key: str) -> bool:
        """Scroll or close; return whether the key was for the panel alone."""
        if not self.is_open:
            return False
        if key in _SCROLL_KEYS and self.max_scroll_y > 0:
            {
                "up": self.scroll_up,
                "down": self.scroll_down,
                "pageup": self.scroll_page_up,
                "pagedown": self.scroll_page_down,
                "home": self.scroll_home,
                "end": self.scroll_end,
            }[key](animate=False)
            return True
        self.close()
        return len(key) > 1

    def on_click(self) -> None:
        """Close the panel."""
        self.close()
        self._on_click_close()

    def _describe_keys(self) -> None:
        if self.max_scroll_y > 0:
            self.border_subtitle = "↑ ↓ scroll, others close"


def list_places(places: Mapping[str, Pose2]) -> RenderableType:
    """List the waypoints, one a line."""
    table = Table.grid(padding=(0, 2), pad_edge=False)
    for name, place in places.items():
        table.add_row(Text(name, "cyan"), format_pose(place))
    table.add_row(Text("m NAME" if places else "w NAME", "dim"), Text(_hint(bool(places)), "dim"))
    return table


def _hint(some: bool) -> str:
    return "drives to a waypoint" if some else "remembers where the robot is; there are no waypoints yet"
