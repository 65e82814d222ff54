"""Commands without a terminal: one after another, one result line each."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from ur.source.diagnostic import UserError
from ur_nodes.client.driver_text import DriverRequest
from ur_nodes.client.mux import MuxRequest
from ur_nodes.client.patrol_text import PatrolRoute
from ur_nodes.client.saving import MapSaving, Saving
from ur_nodes.client.snapshot import GoalReport, LastGoalState, NavigationClient, RobotSnapshot, format_pose
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.teleop.navigate import commands as c
from ur_nodes.teleop.navigate.command_line import route_of, target_of
from ur_nodes.teleop.navigate.commands import bad_command_error, error_line
from ur_nodes.teleop.navigate.status_text import reason_not_to_drive, silence_line


@dataclass(frozen=True, slots=True)
class BatchTimeouts:
    """Timeouts in s: until map, pose and navigation are available, and for one goal."""

    start: float = 30.0
    goal: float = 600.0


def result_line(text: str, report: GoalReport, snapshot: RobotSnapshot, seconds: float) -> str:
    """Describe the end of a goal: `g 2 3 90: reached, 0.04 m and 1.2 degrees off, 12.3 s`."""
    goal, pose = report.pose, snapshot.pose
    if report.state is LastGoalState.REACHED and goal is not None and pose is not None:
        off = math.hypot(goal.x - pose.x, goal.y - pose.y)
        turned = math.degrees(abs(wrap_angle(goal.yaw - pose.yaw)))
        angle = "" if report.any_heading else f" and {turned:.1f} degrees"
        doubt = f"; {report.text}" if report.text else ""
        return f"{text}: reached, {off:.2f} m{angle} off, {seconds:.1f} s{doubt}"
    why = f": {report.text}" if report.text else ""
    return f"{text}: {report.state.value} after {seconds:.1f} s{why}"


def reason_to_give_up(snapshot: RobotSnapshot, seconds: float, limits: BatchTimeouts) -> str:
    """Return the reason to stop waiting for a goal after `seconds`; empty while there is none."""
    silent = silence_line(snapshot)
    if seconds > limits.goal:
        limit = f"not reached after {seconds:.0f} s, the limit (parameter ~goal_timeout)"
        return f"unknown: {limit}; {silent}" if silent else f"failed: {limit}; stopped"
    if snapshot.silence is not None and snapshot.silence.seconds > limits.start:
        return f"unknown after {seconds:.1f} s: {silent}"
    return ""


def goal_change(snapshot: RobotSnapshot, noted: LastGoalState | None) -> LastGoalState | None:
    """Return the state of a goal that is worth a note; None while it is driven. `noted` is the one before."""
    state = snapshot.goal.state
    if state in (LastGoalState.HELD, LastGoalState.UNKNOWN):
        return state
    return None if state is LastGoalState.DRIVING else noted


def describe_change(snapshot: RobotSnapshot, change: LastGoalState | None) -> str:
    """Return a clause about a goal that is held or unknown, or that continues (None)."""
    if change is LastGoalState.HELD:
        return snapshot.goal.text
    if change is LastGoalState.UNKNOWN:
        return f"{silence_line(snapshot)}; the goal is unknown until it answers"
    return "driving"


_ANSWER_WAIT = 5.0  # s: for the mux
_PATROL_DONE = {"start": "started", "pause": "paused", "resume": "goes on", "end": "ended"}
_CANCEL_WAIT = 1.0  # s: for the confirmation that a goal is cancelled

Write = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class BatchContext:
    """The output, the clock and the input of a batch. `sleep` returns True when the batch is to end."""

    out: Write
    err: Write
    clock: Callable[[], float]
    sleep: Callable[[float], bool]
    recording: Saving
    """Saves what has happened."""
    urgent: Callable[[], c.Command | None] | None = None
    """Return a command that was typed meanwhile and must not wait; None without a user to type one."""
    saving: MapSaving | None = None
    """Saves the map that is being made; None where none is being made."""


class InterruptedBatchError(Exception):
    """The batch must end now; the text describes the end of the goal."""


def wait_until_ready(navigator: NavigationClient, limits: BatchTimeouts, around: BatchContext) -> str | None:
    """Wait for everything that a goal needs; return None, or what is missing after the timeout."""
    deadline = around.clock() + limits.start
    while missing := navigator.snapshot().missing:
        if around.clock() >= deadline:
            return " and ".join(missing)
        if around.sleep(0.1):
            raise InterruptedBatchError
    return None


def run_batch(
    lines: Iterable[str], navigator: NavigationClient, store: WaypointStore, limits: BatchTimeouts, around: BatchContext
) -> int:
    """Run each line. Returns the exit code: 1 when a goal failed or a line could not be understood, else 0."""
    batch = _Batch(navigator, store, limits, around)
    code = 0
    for line in lines:
        text = line.strip()
        try:
            command = c.parse_command(text)
            if isinstance(command, c.Quit):
                break
            if command is not None and not batch.run(command, text):
                code = 1
        except UserError as problem:
            around.err(f"error: {text}: {error_line(problem)}")
            code = 1
    return code


class _Batch:
    """Runs commands one after another. `text` is always the line of the command, which begins its result line."""

    def __init__(
        self, navigator: NavigationClient, store: WaypointStore, limits: BatchTimeouts, around: BatchContext
    ) -> None:
        self._navigator, self._store, self._limits, self._around = navigator, store, limits, around

    def run(self, command: c.AtOnce | c.Awaited, text: str) -> bool:
        """Run a command and return whether it succeeded. Raises UserError."""
        match command:
            case c.Go() | c.GoToWaypoint():
                return self._drive(command, text)
            case c.AskLease():
                return self._ask_lease(command.request, text)
            case c.DrivePatrol():
                return self._ask_patrol(command, text)
            case c.AskMux():
                return self._ask_mux(command.request, text)
            case c.StoreMap():
                # Save the map that is being made. Raises UserError if none is being made.
                if self._around.saving is None:
                    raise bad_command_error(c.NO_MAPPING)
                return self._save(self._around.saving, text)
            case c.StoreRecording():
                return self._save(self._around.recording, text)
            case _:
                self._around.out(self._do_at_once(command, text))
                return True

    def _sleep(self, seconds: float) -> None:
        if self._around.sleep(seconds):
            raise InterruptedBatchError

    def _save(self, saving: Saving, text: str) -> bool:
        """Call the service, and print its answer."""
        before = saving.count
        saving.ask()
        while saving.count == before:
            self._sleep(0.05)
        self._around.out(f"{text}: {saving.line}")
        return saving.success

    def _ask_mux(self, request: MuxRequest, text: str) -> bool:
        """Send a request to the mux and return whether it took effect; an emergency stop ends the goal, too."""
        deadline = self._around.clock() + _ANSWER_WAIT
        if request == "stop":
            self._navigator.stop()
        self._navigator.ask_mux(request)
        while (mux := self._navigator.snapshot().mux).asked is not None and self._around.clock() < deadline:
            self._sleep(0.02)
        late = f"no answer within {_ANSWER_WAIT:g} s" if mux.asked is not None else ""
        done = "emergency stop" if request == "stop" else "released"
        self._around.out(f"{text}: {mux.problem or late or done}")
        return not (mux.problem or late)

    def _ask_patrol(self, command: c.DrivePatrol, text: str) -> bool:
        """Send a request to the patrol node and return whether it was accepted; the patrol continues by itself."""
        route = route_of(command, self._store) if command.names else PatrolRoute()
        deadline = self._around.clock() + _ANSWER_WAIT
        asked = self._navigator.ask_patrol(command.action, route)
        while self._around.clock() < deadline:
            patrol = self._navigator.snapshot().patrol
            if patrol and patrol.answer and patrol.answer.id == asked:
                problem = patrol.answer.problem
                self._around.out(f"{text}: {f'refused: {problem}' if problem else _PATROL_DONE[command.action]}")
                return not problem
            self._sleep(0.02)
        self._around.out(f"{text}: no answer within {_ANSWER_WAIT:g} s")
        return False

    def _ask_lease(self, request: DriverRequest, text: str) -> bool:
        """Send a lease request and return whether it took effect in time; `ask` waits longer, for a user's answer."""
        wait = self._limits.start if request == "ask" else _ANSWER_WAIT
        deadline = self._around.clock() + wait
        self._navigator.request_lease(request)
        while (snapshot := self._navigator.snapshot()).lease.mine is (request == "grant"):
            if self._around.clock() >= deadline:
                reason = reason_not_to_drive(snapshot)
                self._around.out(f"{text}: not done within {wait:g} s{f': {reason}' if reason else ''}")
                return False
            self._sleep(0.05)
        self._around.out(f"{text}: {'handed over' if request == 'grant' else 'drives now'}")
        return True

    def _do_at_once(self, command: c.AtOnce, text: str) -> str:
        """Run a command that ends at once and return its result line. Raises UserError."""
        match command:
            case c.Remember():
                pose = self._navigator.snapshot().pose
                assert pose is not None, "waited for before the first line"
                fresh = self._store.remember(command.name, pose)
                return f"{text}: {'saved at' if fresh else 'moved to'} {format_pose(pose)}"
            case c.Forget():
                self._store.forget(command.name)
                return f"{text}: deleted"
            case c.ListPlaces():
                places = (f"{name}: {format_pose(place)}" for name, place in self._store.places().items())
                return "\n".join(places) or f"{text}: no waypoints yet"
            case c.CancelGoal():
                self._navigator.stop()
                return f"{text}: stopped"
            case c.SetPose() | c.Relocalise():
                if reason := reason_not_to_drive(self._navigator.snapshot()):
                    raise bad_command_error(f"not done: {reason}")
                if isinstance(command, c.SetPose):
                    self._navigator.set_pose(Pose2(command.x, command.y, command.yaw))
                    return f"{text}: pose set"
                self._navigator.relocalise()
                return f"{text}: searching for the robot on the whole map"
            case c.Follow() | c.SwitchTheme():
                raise bad_command_error("there is no map to show, expected a terminal for this command")
            case c.Help():
                return "\n".join(f"{usage:<14} {meaning}" for usage, meaning in c.USAGE.values())

    # -- goals -----------------------------------------------------------------------------------------------------

    def _drive(self, command: c.Go | c.GoToWaypoint, text: str) -> bool:
        """Send a goal and wait for its end; return whether it was reached."""
        navigator, around = self._navigator, self._around
        place, any_heading = target_of(command, navigator.snapshot(), self._store)
        if reason := self._wait_until_allowed():
            around.out(f"{text}: not sent: {reason}")
            return False
        start = around.clock()
        number, noted = navigator.go(place, any_heading=any_heading), None
        while True:
            snapshot = navigator.snapshot()
            report, seconds = snapshot.goal, around.clock() - start
            if report.number > number:
                if snapshot.lease.taken_by:
                    around.out(f"{text}: stopped after {seconds:.1f} s: {snapshot.lease.taken_by} took over")
                    return False
                around.out(f"{text}: failed: another goal took its place after {seconds:.1f} s")
                return False
            if report.number == number and report.over:
                break
            if around.urgent and (typed := around.urgent()):
                # Run a command that was typed while a goal is driven
                if isinstance(typed, c.AskMux):
                    self._ask_mux(typed.request, "emergency" if typed.request == "stop" else "release")
                else:
                    self._navigator.stop()
            if ended := reason_to_give_up(snapshot, seconds, self._limits):
                navigator.stop()
                around.out(f"{text}: {ended}")
                return False
            change = goal_change(snapshot, noted)
            if change is not noted:
                around.err(f"note: {text}: {describe_change(snapshot, change)}")
                noted = change
            if around.sleep(0.05):
                raise InterruptedBatchError(self._cancel())
        around.out(result_line(text, report, snapshot, seconds))
        return report.state is LastGoalState.REACHED

    def _wait_until_allowed(self) -> str:
        """Wait while the robot is silent or handles a lost lease; return the reason why no goal can be sent, or ''."""
        deadline = self._around.clock() + self._limits.start
        while _is_undecided(snapshot := self._navigator.snapshot()) and self._around.clock() < deadline:
            self._sleep(0.05)
        return reason_not_to_drive(snapshot)

    def _cancel(self) -> str:
        """Cancel the goal, and return a text about the result."""
        self._navigator.stop()
        deadline = self._around.clock() + _CANCEL_WAIT
        while not (snapshot := self._navigator.snapshot()).goal.over and self._around.clock() < deadline:
            self._around.sleep(0.02)
        if snapshot.goal.over:
            return "the goal was cancelled"
        return f"the goal may not be cancelled: {silence_line(snapshot) or 'no answer'}"


def _is_undecided(snapshot: RobotSnapshot) -> bool:
    lease = snapshot.lease
    return snapshot.silence is not None or (lease.lost_by_other and lease.pending)
