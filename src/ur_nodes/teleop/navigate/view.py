"""The screen of `keyboard_navigate`: map, status, message, command line."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import ClassVar

from rich.text import Text
from textual import events, on
from textual.binding import Binding, BindingType
from textual.driver import Driver
from textual.geometry import Size
from textual.widgets import Static

from ur.source.diagnostic import UserError
from ur.tui.screen.app import FullScreenApp
from ur.tui.screen.query import measure_terminal
from ur_nodes.client.patrol_text import describe_patrol
from ur_nodes.client.saving import MapSaving, Saving
from ur_nodes.client.snapshot import GoalReport, LastGoalState, NavigationClient, RobotSnapshot, format_number
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.palette import MapPalette, choose_palette
from ur_nodes.teleop.map_view.widget import MapView
from ur_nodes.teleop.navigate.command_line import CommandLine
from ur_nodes.teleop.navigate.commands import error_line
from ur_nodes.teleop.navigate.status_text import (
    alarm_line,
    announce_goal,
    driver_line,
    silence_line,
    status_line,
    visible_state,
    waiting_line,
)

REFRESH = 1.0 / 6.0


class NavigateView(FullScreenApp[None]):
    """Shows a `NavigationClient`; a subclass runs commands.

    `store_for` returns the waypoints once a map is known, None as long as it has no name. With `saving` the map grows:
    it can be saved, and the view follows the robot from the start. `recording` saves what has happened. `typed` is what
    was typed before the screen opened; `list_users` names the other users of the robot, which ends with this program.
    """

    CSS = """
    Screen { background: $background; layers: base above; align: center middle; }
    #head, #status, #driver, #message { height: 1; width: 1fr; }
    #status, #driver, #message { height: auto; min-height: 1; max-height: 3; padding: 0 1; }
    #head { background: $primary; color: $text; }
    #status { background: $surface; }
    #driver { color: $warning; display: none; }
    CommandLine { height: 1; border: none; padding: 0 1; background: $background; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [Binding("ctrl+c,ctrl+q", "quit", "Quit", priority=True, show=False)]

    def __init__(
        self,
        navigator: NavigationClient,
        store_for: Callable[[RobotSnapshot], WaypointStore | None],
        *,
        recording: Saving,
        title: str = "",
        saving: MapSaving | None = None,
        light: bool = False,
        driver_class: type[Driver] | None = None,
        typed: str = "",
        list_users: Callable[[], Sequence[str]] = tuple,
    ) -> None:
        super().__init__(driver_class=driver_class)
        self._navigator = navigator
        self._store_for = store_for
        self._list_users = list_users
        self._map_title = title
        self._saving, self._recording = saving, recording
        self._light = light
        self._snapshot = RobotSnapshot()
        self._places: Mapping[str, Pose2] = {}
        self._sent = 0
        self._asked = ""  # the id of a request for a patrol that is not answered yet
        self._shown_key: tuple[object, ...] = ()
        self._announced: tuple[int, LastGoalState] = (0, LastGoalState.NONE)
        self._result_shown = False  # the message is about the goal, or is the last one
        self._was_ready = False
        self._typed = typed

    def on_mount(self) -> None:
        """Set colours and focus, and refresh the screen at a steady rate."""
        self.use_theme(light=self._light)
        self.query_one(CommandLine).focus()
        self._show_message("")
        self._look()
        self.query_one(CommandLine).insert_typed(self._typed)
        self.set_interval(REFRESH, self._look)
        self.set_interval(1.0, self._check_size)

    @property
    def map(self) -> MapView:
        """The map's widget."""
        return self.query_one(MapView)

    def cancel_own_goal(self) -> str:
        """Cancel the goal if it was sent from here. Return a reason why that may have no effect, or ''."""
        snapshot = self._navigator.snapshot()
        report = snapshot.goal
        if not self._sent or report.number != self._sent or report.over:
            return ""
        self._navigator.stop()
        return silence_line(snapshot)

    def _look(self) -> None:
        """Take a snapshot, and draw it if it has changed."""
        if not self.query("#message"):  # the screen is being closed
            return
        snapshot = self._navigator.snapshot()
        if snapshot.grid is not None and (self._snapshot.grid is not snapshot.grid):
            self._snapshot = snapshot
            self._reload_places()
        self._announce(snapshot)
        for saving in (self._saving, self._recording):
            if saving and (news := saving.pop_news()):
                self._show_message(news)
        patrol = snapshot.patrol
        if self._asked and patrol and patrol.answer and patrol.answer.id == self._asked:
            problem, self._asked = patrol.answer.problem, ""
            self._show_message(
                f"refused: {problem}" if problem else describe_patrol(patrol), "bold red" if problem else ""
            )
        key = (*visible_state(snapshot, self._places, self.size), self._result_shown)
        if key == self._shown_key:
            return
        self._shown_key, self._snapshot = key, snapshot
        self.map.show(snapshot, self._places)
        self.query_one("#status", Static).update(self._status())
        # Show who drives; the line is hidden while it is empty
        text, widget = driver_line(self._snapshot, self.size.width), self.query_one("#driver", Static)
        widget.display = bool(text)
        widget.update(Text(text))
        self._draw_head()
        if not self._was_ready and not snapshot.missing:
            self._was_ready = True
            self._become_ready()

    def _become_ready(self) -> None:
        """Handle the first snapshot in which nothing is missing."""

    def _status(self) -> Text:
        snapshot, mux = self._snapshot, self._snapshot.mux
        silent = silence_line(snapshot)
        alarm = alarm_line(snapshot)
        if alarm and (mux.problem or mux.asked or not silent):
            return Text(alarm, "bold white on red")
        if not silent and (waiting := waiting_line(snapshot)):
            return Text(waiting, "yellow")
        if snapshot.goal.over and not self._result_shown:
            snapshot = replace(snapshot, goal=GoalReport(snapshot.goal.number))
        return status_line(snapshot, self.size.width - 2)

    def _draw_head(self) -> None:
        view = self.map
        name = f"  {self._map_title}" if self._map_title else ""
        left = Text.assemble((" keyboard navigate", "bold"), name)
        mode = "following the robot   " if view.following else ""
        where = f"{format_number(view.hover[0], 1)} {format_number(view.hover[1], 1)}   " if view.hover else ""
        right = f"{where}{mode}? help "
        gap = self.size.width - left.cell_len - len(right)
        if gap > 1:
            left.append(" " * gap).append(right, "dim")
        left.no_wrap = True
        self.query_one("#head", Static).update(left)

    def _announce(self, snapshot: RobotSnapshot) -> None:
        report = snapshot.goal
        if (report.number, report.state) == self._announced:
            return
        self._announced = (report.number, report.state)
        if report.pose is not None:
            self._show_message(*announce_goal(snapshot))
            self._result_shown = True

    def _show_message(self, text: str, style: str = "") -> None:
        self._result_shown = self._result_shown and not text  # a result leaves with its message
        self.query_one("#message", Static).update(Text(text, style))

    def _reload_places(self) -> None:
        if self._snapshot.grid is None:
            return
        try:
            if (store := self._store_for(self._snapshot)) is not None:
                self._places = store.places()
        except UserError as problem:
            self._show_message(error_line(problem), "bold red")

    def _check_size(self) -> None:
        """Check for a new size: roslaunch's nodes have no controlling terminal, so no SIGWINCH arrives."""
        if self.is_headless or self._driver is None:
            return
        size = measure_terminal(1)
        if size is not None and size != tuple(self.size):
            self.post_message(events.Resize(Size(*size), Size(*size)))

    @on(MapView.ViewChanged)
    def _view_changed(self) -> None:
        self._draw_head()

    def _palette(self) -> MapPalette:
        return choose_palette(light=self._light, few_colours=self.console.color_system == "standard")
