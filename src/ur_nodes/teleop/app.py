"""The terminal program: map, status, message, command line. Knows a `Navigator`, no ROS."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from typing import ClassVar

from rich.text import Text
from textual import events, on
from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType
from textual.driver import Driver
from textual.geometry import Size
from textual.screen import ModalScreen
from textual.widgets import Static

from ur.source.diagnostic import UserError
from ur_nodes.teleop import commands as c
from ur_nodes.teleop.batch import place_text, target_of
from ur_nodes.teleop.command_line import CommandLine
from ur_nodes.teleop.emergency import Wish
from ur_nodes.teleop.map_widget import MapView
from ur_nodes.teleop.navigator import GoalState, Navigator, Place, Snapshot
from ur_nodes.teleop.palette import DARK, LIGHT
from ur_nodes.teleop.status_text import alarm_line, help_text, status_line, waiting_line
from ur_nodes.teleop.waypoints import WaypointStore

REFRESH = 1.0 / 6.0
_COMMAND_LETTERS = "gmwdsier?q"


class Panel(ModalScreen[None]):
    """A box of text over the map that any key or click closes."""

    DEFAULT_CSS = """
    Panel { align: center middle; background: $background 50%; }
    Panel Static { width: auto; height: auto; max-width: 96%; max-height: 100%; padding: 0 2; border: round $primary;
                   background: $surface; }
    """

    def __init__(self, title: str, text: Text) -> None:
        super().__init__()
        self._title = title
        self._text = text

    def compose(self) -> ComposeResult:
        """The box."""
        box = Static(self._text)
        box.border_title = self._title
        box.border_subtitle = "any key closes this"
        yield box

    def on_key(self, event: events.Key) -> None:
        """Close; the emergency key is one here, too."""
        event.stop()
        self.dismiss()
        if event.key == "space":
            self.post_message(CommandLine.EmergencyKey())

    def on_click(self) -> None:
        """Close."""
        self.dismiss()


class NavigateApp(App[None]):
    """Shows what `navigator` knows and asks things of it. `store_for` gives the waypoints once a map is known."""

    ENABLE_COMMAND_PALETTE = False
    CSS = """
    Screen { background: $background; }
    #head, #status, #message { height: 1; width: 1fr; }
    #head { background: $primary; color: $text; }
    #status { background: $surface; }
    CommandLine { height: 1; border: none; padding: 0 1; background: $background; }
    """
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("ctrl+c,ctrl+q", "quit", "Quit", priority=True, show=False),
        Binding("plus,equals_sign", "zoom(1.25)", show=False),
        Binding("minus", "zoom(0.8)", show=False),
        Binding("0", "fit", show=False),
        Binding("f", "follow", show=False),
        Binding("t", "light", show=False),
        Binding("left,h", "pan(-0.1,0)", show=False),
        Binding("right,l", "pan(0.1,0)", show=False),
        Binding("up,k", "pan(0,-0.1)", show=False),
        Binding("down,j", "pan(0,0.1)", show=False),
        Binding("pageup", "zoom(1.25)", show=False),
        Binding("pagedown", "zoom(0.8)", show=False),
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
        self._places: Mapping[str, Place] = {}
        self._sent = 0
        self._shown_key: tuple[object, ...] = ()
        self._announced: tuple[int, GoalState] = (0, GoalState.NONE)

    def compose(self) -> ComposeResult:
        """Head, map, status, message, command line."""
        yield Static(id="head")
        yield MapView(LIGHT if self._light else DARK, id="map")
        yield Static(id="status")
        yield Static(id="message")
        yield CommandLine(id="line")

    def on_mount(self) -> None:
        """Colours, focus, and the clock that looks for news."""
        self.theme = "textual-light" if self._light else "textual-dark"
        self.query_one(CommandLine).focus()
        self._say("")
        self._look()
        self.set_interval(REFRESH, self._look)
        self.set_interval(1.0, self._check_size)

    @property
    def map(self) -> MapView:
        """The map's widget."""
        return self.query_one(MapView)

    def stop_what_was_sent(self) -> None:
        """Cancel the goal if it is one of ours: nobody watches any more."""
        report = self._navigator.snapshot().goal
        if self._sent and report.number == self._sent and not report.over:
            self._navigator.stop()

    def _look(self) -> None:
        """Take a snapshot; draw when it differs."""
        snapshot = self._navigator.snapshot()
        if snapshot.grid is not None and (self._snapshot.grid is not snapshot.grid):
            self._snapshot = snapshot
            self._reload_places()
        self._announce(snapshot)
        key = _key_of(snapshot, self._places, self.size)
        if key == self._shown_key:
            return
        self._shown_key, self._snapshot = key, snapshot
        self.map.show(snapshot, self._places)
        self.query_one("#status", Static).update(self._status())
        self._draw_head()

    def _status(self) -> Text:
        alarm = alarm_line(self._snapshot)
        if alarm:
            return Text(f" {alarm}", "bold white on red", no_wrap=True, overflow="ellipsis")
        waiting = waiting_line(self._snapshot)
        if waiting:
            return Text(f" {waiting}", "yellow", no_wrap=True, overflow="ellipsis")
        return status_line(self._snapshot, self.size.width)

    def _draw_head(self) -> None:
        view = self.map
        name = f"  {self._map_title}" if self._map_title else ""
        left = Text.assemble((" keyboard navigate", "bold"), name)
        mode = "follows the robot" if view.following else f"{view.view.scale * 100:.0f} cm per dot"
        where = f"{view.hover[0]:.1f} {view.hover[1]:.1f}   " if view.hover else ""
        right = f"{where}{mode}   ? help "
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
        if report.place is None:
            return
        where = place_text(report.place)
        if report.state is GoalState.REACHED and snapshot.pose is not None:
            off = math.hypot(report.place.x - snapshot.pose.x, report.place.y - snapshot.pose.y)
            self._say(f"reached {where}, {off:.2f} m off", "green")
        elif report.state is GoalState.FAILED:
            self._say(f"{where}: failed: {report.text}", "bold red")
        elif report.state is GoalState.STOPPED:
            self._say(f"stopped on the way to {where}", "yellow")
        else:
            self._say(f"driving to {where}")

    def _say(self, text: str, style: str = "") -> None:
        self.query_one("#message", Static).update(Text(f" {text}", style, no_wrap=True, overflow="ellipsis"))

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
        try:
            columns, rows = os.get_terminal_size(1)
        except OSError:
            return
        if columns and rows and (columns, rows) != tuple(self.size):
            self.post_message(events.Resize(Size(columns, rows), Size(columns, rows)))

    @on(MapView.GoalPicked)
    def _goal_picked(self, message: MapView.GoalPicked) -> None:
        self._send(message.place)

    @on(MapView.ViewChanged)
    def _view_changed(self) -> None:
        self._draw_head()

    @on(CommandLine.MapKey)
    async def _map_key(self, message: CommandLine.MapKey) -> None:
        await self.run_action(_ACTIONS[message.key])

    @on(CommandLine.EmergencyKey)
    def _emergency(self) -> None:
        self._do(c.AskMux("stop"))

    @on(CommandLine.Entered)
    def _entered(self, message: CommandLine.Entered) -> None:
        try:
            command = c.parse_command(message.line)
            if command is not None:
                self._do(command)
        except UserError as problem:
            self._say(c.error_line(problem), "bold red")

    def on_key(self, event: events.Key) -> None:
        """With the map in focus a command's first letter goes to the command line."""
        line = self.query_one(CommandLine)
        if event.key == "space":
            self._do(c.AskMux("stop"))
            event.stop()
        elif event.character and event.character in _COMMAND_LETTERS and self.focused is not line:
            line.focus()
            line.value += event.character
            line.cursor_position = len(line.value)
            event.stop()

    def _do(self, command: c.Command) -> None:
        """Run a command. Raises UserError."""
        if isinstance(command, c.Quit):
            self.exit()
        elif isinstance(command, c.Help):
            self.push_screen(Panel("help", help_text()))
        elif isinstance(command, c.Stop):
            self._navigator.stop()
            self._say("stopped" if not self._snapshot.goal.over else "there was no goal to stop", "yellow")
        elif isinstance(command, c.AskMux):
            self._ask_mux(command.wish)
        elif isinstance(command, c.ListPlaces):
            self.push_screen(Panel("waypoints", self._list()))
        elif isinstance(command, (c.Go, c.GoTo)):
            self._send(target_of(command, self._snapshot, self._store()))
        elif isinstance(command, c.SetPose):
            place = Place(command.x, command.y, command.yaw)
            self._navigator.set_pose(place)
            self._say(f"told the localiser that the robot is at {place_text(place)}")
        elif isinstance(command, c.Relocalise):
            self._navigator.relocalise()
            self._say("the localiser looks for the robot everywhere; drive a little to help it")
        else:
            self._change_places(command)

    def _ask_mux(self, wish: Wish) -> None:
        if wish == "stop" and not self._snapshot.goal.over:
            self._navigator.stop()
        self._navigator.ask_mux(wish)
        self._say("")
        self._look()

    def _change_places(self, command: c.Remember | c.Forget) -> None:
        store = self._store()
        if isinstance(command, c.Forget):
            store.forget(command.name)
            self._say(f"{command.name} dropped")
        else:
            pose = self._navigator.snapshot().pose
            if pose is None:
                raise c.bad_command_error("the robot's pose is not known yet, expected a localised robot")
            fresh = store.remember(command.name, pose)
            self._say(f"{command.name} {'is' if fresh else 'is now'} {place_text(pose)}")
        self._reload_places()
        self._look()

    def _store(self) -> WaypointStore:
        if self._snapshot.grid is None:
            raise c.bad_command_error("the map is not there yet, expected one: waypoints belong to a map")
        return self._store_for(self._snapshot)

    def _list(self) -> Text:
        places = self._store().places()
        text = Text()
        width = max((len(name) for name in places), default=0)
        for name, place in places.items():
            text.append(f"{name:<{width}}  ", "cyan").append(f"{place_text(place)}\n")
        return text.append("m NAME goes there" if places else "none yet: w NAME remembers where the robot is", "dim")

    def _send(self, place: Place) -> None:
        if self._navigator.snapshot().missing:
            self._say(f"not sent: {waiting_line(self._navigator.snapshot())}", "yellow")
            return
        if self._navigator.snapshot().mux.stopped:
            self._say("not sent: the emergency stop is on; r and Enter let the robot drive again", "yellow")
            return
        self._sent = self._navigator.go(place)
        self._look()

    def action_zoom(self, factor: float) -> None:
        """Zoom the map."""
        self.map.zoom(factor)

    def action_pan(self, columns: float, rows: float) -> None:
        """Move the map by parts of the screen."""
        self.map.pan(columns, rows)

    def action_fit(self) -> None:
        """Show the whole map."""
        self.map.fit()

    def action_follow(self) -> None:
        """Follow the robot, or do not."""
        self.map.toggle_follow()

    def action_light(self) -> None:
        """Change between dark and light."""
        self._light = not self._light
        self.theme = "textual-light" if self._light else "textual-dark"
        self.map.set_palette(LIGHT if self._light else DARK)


_ACTIONS = {
    "plus": "zoom(1.25)",
    "equals_sign": "zoom(1.25)",
    "pageup": "zoom(1.25)",
    "minus": "zoom(0.8)",
    "pagedown": "zoom(0.8)",
    "0": "fit",
    "f": "follow",
    "t": "light",
    "left": "pan(-0.1,0)",
    "right": "pan(0.1,0)",
}


def _key_of(snapshot: Snapshot, places: Mapping[str, Place], size: Size) -> tuple[object, ...]:
    """What the picture depends on, rounded to what can be seen."""
    pose = snapshot.pose
    return (
        id(snapshot.grid),
        (round(pose.x, 3), round(pose.y, 3), round(pose.yaw, 3)) if pose else None,
        snapshot.scan.round(2).tobytes() if snapshot.scan is not None and snapshot.goal.over else id(snapshot.scan),
        id(snapshot.path),
        snapshot.goal,
        round(snapshot.speed, 2),
        round(snapshot.spread, 2) if snapshot.spread is not None else None,
        snapshot.missing,
        snapshot.mux,
        tuple(places.items()),
        size,
    )
