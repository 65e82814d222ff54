"""The program `keyboard_navigate` on a terminal: commands and keys. Depends on a `Navigator`, not on ROS."""

from collections.abc import Callable
from functools import singledispatchmethod

from textual import on
from textual.app import ComposeResult
from textual.timer import Timer
from textual.widgets import Static

from ur.source.diagnostic import UserError
from ur.source.run_users import describe_users
from ur_nodes.client.patrol_text import PatrolRoute
from ur_nodes.client.snapshot import format_pose
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.map_view.widget import MapView
from ur_nodes.teleop.navigate import commands as c
from ur_nodes.teleop.navigate.command_line import CommandLine, route_of, target_of
from ur_nodes.teleop.navigate.commands import bad_command_error, error_line
from ur_nodes.teleop.navigate.panel import Panel, list_places
from ur_nodes.teleop.navigate.status_text import (
    REQUESTED,
    describe_stop,
    help_table,
    reason_not_to_drive,
    reason_not_to_send,
)
from ur_nodes.teleop.navigate.view import NavigateView

MOST_WAITING = 60.0  # s that a goal waits for the robot to be ready


class NavigateApp(NavigateView):
    """The screen of a `Navigator`, which obeys commands and keys.

    A goal that is typed before the robot is ready for the first time is sent as soon as it is; a stop drops it.
    """

    _waiting_line = ""
    _asks_to_end = False
    _waiting_timer: Timer | None = None

    def compose(self) -> ComposeResult:
        """Lay out head, map, status, driver, message and command line."""
        yield Static(id="head")
        yield MapView(self._palette(), id="map")
        yield Static(id="status")
        yield Static(id="driver")
        yield Static(id="message")
        yield CommandLine(self, id="line")
        yield Panel(self._panel_clicked, id="panel")

    @on(MapView.GoalPicked)
    def _goal_picked(self, message: MapView.GoalPicked) -> None:
        self._send(message.place, any_heading=message.any_heading)

    def press_key(self, key: str) -> bool:
        """Pass the key to an open panel or question, in which the emergency key also works."""
        if self._asks_to_end and key == "q":
            self.exit()
        elif self._asks_to_end:
            self._asks_to_end = False
            self._show_message("")
        elif not self.query_one(Panel).press_key(key):
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
        """Run the command of a line, or report what is wrong with it."""
        try:
            command = c.parse_command(line)
            if (
                isinstance(command, (c.Go, c.GoToWaypoint))
                and not self._was_ready
                and not reason_not_to_drive(self._snapshot)
            ):
                # Keep a goal that was typed before the robot was first ready; a later goal replaces it
                if self._waiting_timer is not None:
                    self._waiting_timer.stop()
                self._waiting_line = line
                self._waiting_timer = self.set_timer(MOST_WAITING, self._give_up)
                self._show_message(f"'{line}' is sent when the robot is ready; s cancels it")
            elif command is not None:
                self._do(command)
        except UserError as problem:
            self._show_message(error_line(problem), "bold red")

    async def action_quit(self) -> None:
        """End the program by Ctrl-C, as `q` does."""
        self._leave()

    def _leave(self) -> None:
        """End the program; if that ends the robot of another user, ask once."""
        users = "" if self._asks_to_end else describe_users(self._list_users())
        if not users:
            self.exit()
            return
        self._asks_to_end = True
        self._show_message(
            f"{users}; it ends with this program. Press q again to end it, or any other key to stay", "bold yellow"
        )

    def _give_up(self) -> None:
        if self._waiting_line:
            self._show_message(
                f"'{self._waiting_line}' was not sent: the robot was not ready within {MOST_WAITING:g} s", "yellow"
            )
        self._waiting_line = ""

    def _become_ready(self) -> None:
        """Send the waiting goal. Called once."""
        line, self._waiting_line = self._waiting_line, ""
        if line:
            self.enter(line)

    def _panel_clicked(self) -> None:
        self.map.ignore_double_click()

    @singledispatchmethod
    def _do(self, command: c.Command) -> None:
        """Run a command: the method below that is registered for its class. Raises UserError."""
        raise NotImplementedError(command)

    @_do.register
    def _quit(self, _: c.Quit) -> None:
        self._leave()

    @_do.register
    def _cancel(self, _: c.CancelGoal) -> None:
        self._waiting_line = ""
        self._navigator.stop()
        self._show_message(describe_stop(self._snapshot), "yellow")

    @_do.register
    def _ask_lease(self, command: c.AskLease) -> None:
        self._navigator.request_lease(command.request)
        self._show_message(REQUESTED[command.request])

    @_do.register
    def _set_pose(self, command: c.SetPose) -> None:
        self._require_to_drive()
        place = Pose2(command.x, command.y, command.yaw)
        self._navigator.set_pose(place)
        self._show_message(f"pose set to {format_pose(place)}")

    @_do.register
    def _save_map(self, _: c.StoreMap) -> None:
        if self._saving is None:
            raise bad_command_error(c.NO_MAPPING)
        self._saving.ask()

    @_do.register
    def _save_recording(self, _: c.StoreRecording) -> None:
        self._recording.ask()

    @_do.register
    def _relocalise(self, _: c.Relocalise) -> None:
        self._require_to_drive()
        self._navigator.relocalise()
        self._show_message("searching for the robot on the whole map; drive a little to help")

    @_do.register
    def _drive_patrol(self, command: c.DrivePatrol) -> None:
        route = route_of(command, self._store()) if command.names else PatrolRoute()
        self._asked = self._navigator.ask_patrol(command.action, route)
        self._show_message("asked the robot")

    @_do.register(c.Go)
    @_do.register(c.GoToWaypoint)
    def _drive(self, command: c.Go | c.GoToWaypoint) -> None:
        place, any_heading = target_of(command, self._snapshot, self._store())
        self._send(place, any_heading=any_heading)

    @_do.register
    def _show_help(self, _: c.Help) -> None:
        self.query_one(Panel).open("help", help_table())

    @_do.register
    def _list_places(self, _: c.ListPlaces) -> None:
        self.query_one(Panel).open("waypoints", list_places(self._store().places()))

    @_do.register
    def _follow(self, _: c.Follow) -> None:
        self.map.toggle_follow()

    @_do.register
    def _switch_theme(self, _: c.SwitchTheme) -> None:
        self._light = not self._light
        self.use_theme(light=self._light)
        self.map.set_palette(self._palette())

    def _require_to_drive(self) -> None:
        """Raise UserError if another client drives."""
        if reason := reason_not_to_drive(self._navigator.snapshot()):
            raise bad_command_error(f"not done: {reason}")

    @_do.register
    def _ask_mux(self, command: c.AskMux) -> None:
        if command.request == "stop":
            self._waiting_line = ""
            if not self._snapshot.goal.over:
                self._navigator.stop()
        self._navigator.ask_mux(command.request)
        self._show_message("")
        self._look()

    @_do.register
    def _remember(self, command: c.Remember) -> None:
        pose = self._navigator.snapshot().pose
        if pose is None:
            raise bad_command_error("the robot's pose is not known yet, expected a localised robot")
        fresh = self._store().remember(command.name, pose)
        self._show_places(f"waypoint '{command.name}' {'saved at' if fresh else 'moved to'} {format_pose(pose)}")

    @_do.register
    def _forget(self, command: c.Forget) -> None:
        self._store().forget(command.name)
        self._show_places(f"waypoint '{command.name}' deleted")

    def _show_places(self, message: str) -> None:
        """Show the waypoints as they are now, and what has changed."""
        self._show_message(message)
        self._reload_places()
        self._look()

    def _store(self) -> WaypointStore:
        if self._snapshot.grid is None:
            raise bad_command_error("no map yet, expected one on topic map; waypoints belong to a map")
        store = self._store_for(self._snapshot)
        if store is None:
            raise bad_command_error("the map has no name yet, expected one as soon as it is saved; try again")
        return store

    def _send(self, pose: Pose2, *, any_heading: bool) -> None:
        if reason := reason_not_to_send(self._navigator.snapshot()):
            self._show_message(f"not sent: {reason}", "yellow")
            return
        try:
            self._sent = self._navigator.go(pose, any_heading=any_heading)
        except UserError as problem:
            self._show_message(f"not sent: {error_line(problem)}", "bold red")
        self._look()


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
    "t": lambda app: app._do(c.SwitchTheme()),  # noqa: SLF001 - this module's own
}
