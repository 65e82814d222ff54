"""The terminal program: map, status, message, command line. Knows a `Navigator`, no ROS."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import ClassVar

from rich.text import Text
from textual import events, on
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.driver import Driver
from textual.geometry import Size
from textual.widgets import Static

from ur.screen.app import FullScreenApp
from ur.screen.query import measure_terminal
from ur.source.diagnostic import UserError
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.palette import Palette, choose_palette
from ur_nodes.teleop.map_view.widget import MapView
from ur_nodes.teleop.mux.emergency import MuxRequest
from ur_nodes.teleop.navigate import commands as c
from ur_nodes.teleop.navigate.batch import target_of
from ur_nodes.teleop.navigate.command_line import CommandLine
from ur_nodes.teleop.navigate.message_text import REQUESTED, announce_goal, describe_stop, visible_state
from ur_nodes.teleop.navigate.panel import Panel, list_places
from ur_nodes.teleop.navigate.status_text import (
    alarm_line,
    asking_line,
    driver_line,
    help_table,
    reason_not_to_drive,
    reason_not_to_send,
    silence_line,
    status_line,
    waiting_line,
)
from ur_nodes.teleop.navigate.waypoints import WaypointStore
from ur_nodes.teleop.navigator.model import GoalState, Navigator, Snapshot, format_number, format_place

REFRESH = 1.0 / 6.0


class NavigateApp(FullScreenApp[None]):
    """The screen of a `Navigator`. `store_for` returns the waypoints once a map is known."""

    CSS = """
    Screen { background: $background; layers: base above; align: center middle; }
    #head, #status, #driver, #message { height: 1; width: 1fr; }
    #status, #driver, #message { height: auto; min-height: 1; max-height: 3; padding: 0 1; }
    #head { background: $primary; color: $text; }
    #status { background: $surface; }
    #driver { color: $warning; display: none; }
    CommandLine { height: 1; border: none; padding: 0 1; background: $background; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c,ctrl+q", "quit", "Quit", priority=True, show=False),
    ]

    def __init__(
        self,
        navigator: Navigator,
        store_for: Callable[[Snapshot], WaypointStore],
        *,
        title: str = "",
        light: bool = False,
        driver_class: type[Driver] | None = None,
    ) -> None:
        super().__init__(driver_class=driver_class)
        self._navigator = navigator
        self._store_for = store_for
        self._map_title = title
        self._light = light
        self._snapshot = Snapshot()
        self._places: Mapping[str, Pose2] = {}
        self._sent = 0
        self._shown_key: tuple[object, ...] = ()
        self._announced: tuple[int, GoalState] = (0, GoalState.NONE)

    def compose(self) -> ComposeResult:
        """Head, map, status, who drives, message, command line."""
        yield Static(id="head")
        yield MapView(self._palette(), id="map")
        yield Static(id="status")
        yield Static(id="driver")
        yield Static(id="message")
        yield CommandLine(self, id="line")
        yield Panel(self._panel_clicked, id="panel")

    def on_mount(self) -> None:
        """Set colours and focus, and refresh the screen at a steady rate."""
        self.use_theme(light=self._light)
        self.query_one(CommandLine).focus()
        self._say("")
        self._look()
        self.set_interval(REFRESH, self._look)
        self.set_interval(1.0, self._check_size)

    @property
    def map(self) -> MapView:
        """The map's widget."""
        return self.query_one(MapView)

    def cancel_own_goal(self) -> str:
        """Cancel the goal if it was sent from here. Return a reason why that may have no effect, or nothing."""
        snapshot = self._navigator.snapshot()
        report = snapshot.goal
        if not self._sent or report.number != self._sent or report.over:
            return ""
        self._navigator.stop()
        return silence_line(snapshot)

    def _look(self) -> None:
        """Take a snapshot; draw when it differs."""
        snapshot = self._navigator.snapshot()
        if snapshot.grid is not None and (self._snapshot.grid is not snapshot.grid):
            self._snapshot = snapshot
            self._reload_places()
        self._announce(snapshot)
        key = visible_state(snapshot, self._places, self.size)
        if key == self._shown_key:
            return
        self._shown_key, self._snapshot = key, snapshot
        self.map.show(snapshot, self._places)
        self.query_one("#status", Static).update(self._status())
        self._show_driver()
        self._draw_head()

    def _status(self) -> Text:
        snapshot, mux = self._snapshot, self._snapshot.mux
        silent = silence_line(snapshot)
        alarm = alarm_line(snapshot)
        if alarm and (mux.problem or mux.asked or not silent):
            return Text(alarm, "bold white on red")
        if not silent and (waiting := waiting_line(snapshot)):
            return Text(waiting, "yellow")
        if not silent and snapshot.goal.state is GoalState.ASKING:
            return Text(asking_line(self.size.width - 1), "bold black on yellow")
        return status_line(snapshot, self.size.width - 2)

    def _show_driver(self) -> None:
        """Show who drives; the line is there only when there is something to show."""
        text, widget = driver_line(self._snapshot, self.size.width), self.query_one("#driver", Static)
        widget.display = bool(text)
        widget.update(Text(text))

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

    def _announce(self, snapshot: Snapshot) -> None:
        report = snapshot.goal
        if (report.number, report.state) == self._announced:
            return
        self._announced = (report.number, report.state)
        if report.place is not None:
            self._say(*announce_goal(snapshot))

    def _say(self, text: str, style: str = "") -> None:
        self.query_one("#message", Static).update(Text(text, style))

    def _reload_places(self) -> None:
        if self._snapshot.grid is None:
            return
        try:
            self._places = self._store_for(self._snapshot).places()
        except UserError as problem:
            self._say(c.error_line(problem), "bold red")

    def _check_size(self) -> None:
        """Notice a new size without SIGWINCH: roslaunch's nodes have no controlling terminal."""
        if self.is_headless or self._driver is None:
            return
        size = measure_terminal(1)
        if size is not None and size != tuple(self.size):
            self.post_message(events.Resize(Size(*size), Size(*size)))

    @on(MapView.GoalPicked)
    def _goal_picked(self, message: MapView.GoalPicked) -> None:
        self._send(message.place)

    @on(MapView.ViewChanged)
    def _view_changed(self) -> None:
        self._draw_head()

    def take_key(self, key: str) -> bool:
        """Let an open panel have the key; the emergency key is one there, too."""
        if not self.query_one(Panel).take_key(key):
            return False
        if key == "space":
            self.press_emergency_key()
        return True

    def press_map_key(self, key: str) -> None:
        """Act on a key of the map."""
        _MAP_ACTIONS[key](self)

    def press_emergency_key(self) -> None:
        """Stop everything that drives."""
        self._do(c.AskMux("stop"))

    def show_help(self) -> None:
        """Open the help."""
        self._do(c.Help())

    def enter(self, line: str) -> None:
        """Run the command of a line, or say what is wrong with it."""
        try:
            answers = not line and self._snapshot.goal.state is GoalState.ASKING
            command = c.Resume() if answers else c.parse_command(line)
            if command is not None:
                self._do(command)
        except UserError as problem:
            self._say(c.error_line(problem), "bold red")

    def _panel_clicked(self) -> None:
        self.map.ignore_double_click()

    def _do(self, command: c.Command) -> None:
        """Run a command. Raises UserError."""
        if isinstance(command, c.Quit):
            self.exit()
        elif isinstance(command, (c.Help, c.ListPlaces, c.Follow, c.SwitchTheme)):
            self._change_view(command)
        elif isinstance(command, c.Stop):
            self._navigator.stop()
            self._say(describe_stop(self._snapshot), "yellow")
        elif isinstance(command, c.Resume):
            self._resume()
        elif isinstance(command, c.AskLease):
            self._navigator.request_lease(command.request)
            self._say(REQUESTED[command.request])
        elif isinstance(command, c.AskMux):
            self._ask_mux(command.request)
        elif isinstance(command, (c.Go, c.GoTo)):
            self._send(target_of(command, self._snapshot, self._store()))
        elif isinstance(command, c.SetPose):
            self._require_to_drive()
            place = Pose2(command.x, command.y, command.yaw)
            self._navigator.set_pose(place)
            self._say(f"pose set to {format_place(place)}")
        elif isinstance(command, c.Relocalise):
            self._require_to_drive()
            self._navigator.relocalise()
            self._say("searching for the robot on the whole map; drive a little to help")
        else:
            self._change_places(command)

    def _change_view(self, command: c.Help | c.ListPlaces | c.Follow | c.SwitchTheme) -> None:
        if isinstance(command, c.Help):
            self.query_one(Panel).open("help", help_table())
        elif isinstance(command, c.ListPlaces):
            self.query_one(Panel).open("waypoints", list_places(self._store().places()))
        elif isinstance(command, c.Follow):
            self.map.toggle_follow()
        else:
            self._switch_theme()

    def _resume(self) -> None:
        if self._snapshot.goal.state is not GoalState.ASKING:
            self._say("no goal to continue", "yellow")
            return
        self._navigator.resume()
        self._say("goal continued")

    def _require_to_drive(self) -> None:
        """Raise UserError where another client drives."""
        if reason := reason_not_to_drive(self._navigator.snapshot()):
            raise c.bad_command_error(f"not done: {reason}")

    def _ask_mux(self, request: MuxRequest) -> None:
        if request == "stop" and not self._snapshot.goal.over:
            self._navigator.stop()
        self._navigator.ask_mux(request)
        self._say("")
        self._look()

    def _change_places(self, command: c.Remember | c.Forget) -> None:
        store = self._store()
        if isinstance(command, c.Forget):
            store.forget(command.name)
            self._say(f"waypoint '{command.name}' deleted")
        else:
            pose = self._navigator.snapshot().pose
            if pose is None:
                raise c.bad_command_error("the robot's pose is not known yet, expected a localised robot")
            fresh = store.remember(command.name, pose)
            self._say(f"waypoint '{command.name}' {'saved at' if fresh else 'moved to'} {format_place(pose)}")
        self._reload_places()
        self._look()

    def _store(self) -> WaypointStore:
        if self._snapshot.grid is None:
            raise c.bad_command_error("no map yet, expected one on topic map; waypoints belong to a map")
        return self._store_for(self._snapshot)

    def _send(self, place: Pose2) -> None:
        if reason := reason_not_to_send(self._navigator.snapshot()):
            self._say(f"not sent: {reason}", "yellow")
            return
        try:
            self._sent = self._navigator.go(place)
        except UserError as problem:
            self._say(f"not sent: {c.error_line(problem)}", "bold red")
        self._look()

    def _palette(self) -> Palette:
        return choose_palette(light=self._light, few_colours=self.console.color_system == "standard")

    def _switch_theme(self) -> None:
        self._light = not self._light
        self.use_theme(light=self._light)
        self.map.set_palette(self._palette())


_PAN = 0.1  # of the screen
_MAP_ACTIONS: dict[str, Callable[[NavigateApp], object]] = {
    **dict.fromkeys(("plus", "equals_sign", "pageup"), lambda app: app.map.zoom(1.25)),
    **dict.fromkeys(("minus", "pagedown"), lambda app: app.map.zoom(0.8)),
    **dict.fromkeys(("left", "h"), lambda app: app.map.pan(-_PAN, 0.0)),
    **dict.fromkeys(("right", "l"), lambda app: app.map.pan(_PAN, 0.0)),
    **dict.fromkeys(("up", "k"), lambda app: app.map.pan(0.0, -_PAN)),
    **dict.fromkeys(("down", "j"), lambda app: app.map.pan(0.0, _PAN)),
    "0": lambda app: app.map.fit(),
    "f": lambda app: app.map.toggle_follow(),
    "t": lambda app: app._switch_theme(),  # noqa: SLF001 - this module's own
}
