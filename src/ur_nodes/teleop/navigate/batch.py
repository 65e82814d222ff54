"""Commands without a terminal: one after another, one result line each."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from ur.source.diagnostic import UserError
from ur_nodes.geometry.pose import Pose2, wrap_angle
from ur_nodes.teleop.mux.driver_text import DriverRequest
from ur_nodes.teleop.mux.emergency import MuxRequest
from ur_nodes.teleop.navigate.commands import (
    NO_MAPPING,
    USAGE,
    AskLease,
    AskMux,
    Command,
    Follow,
    Forget,
    Go,
    GoTo,
    Help,
    ListPlaces,
    Quit,
    Relocalise,
    Remember,
    Resume,
    SaveMap,
    SetPose,
    Stop,
    SwitchTheme,
    bad_command_error,
    error_line,
    parse_command,
)
from ur_nodes.teleop.navigate.status_text import reason_not_to_drive, silence_line
from ur_nodes.teleop.navigator.model import (
    GoalReport,
    GoalState,
    Navigator,
    Snapshot,
    format_place,
    heading_there,
)
from ur_nodes.teleop.navigator.waypoints import WaypointStore

_ANSWER_WAIT = 5.0  # s: for the mux
_CANCEL_WAIT = 1.0  # s: for the confirmation that a goal is cancelled

Write = Callable[[str], None]
_AtOnce = Remember | Forget | ListPlaces | Stop | Resume | SetPose | Relocalise | Follow | SwitchTheme | Help
_Awaited = Go | GoTo | AskLease | AskMux | SaveMap  # these wait for other computers or programs


@dataclass(frozen=True, slots=True)
class BatchContext:
    """The output, the clock and the input of a batch. `sleep` returns True when the batch is to end."""

    out: Write
    err: Write
    clock: Callable[[], float]
    sleep: Callable[[float], bool]
    urgent: Callable[[], Command | None] | None = None
    """Return a command that was typed meanwhile and must not wait; None where nobody is there to type one."""
    save: Callable[[], str] | None = None
    """Save the map that is being made and return a line about it; None where none is being made."""


@dataclass(frozen=True, slots=True)
class Limits:
    """Seconds: until map, pose and navigation are there, and for one goal."""

    start: float = 30.0
    goal: float = 600.0


class InterruptedBatchError(Exception):
    """The batch is to end now; the text is what became of the goal."""


def wait_until_ready(navigator: Navigator, limits: Limits, around: BatchContext) -> str | None:
    """Wait for everything a goal needs. Returns None, or what is still missing when the time is up."""
    deadline = around.clock() + limits.start
    while missing := navigator.snapshot().missing:
        if around.clock() >= deadline:
            return " and ".join(missing)
        if around.sleep(0.1):
            raise InterruptedBatchError
    return None


def run_batch(
    lines: Iterable[str], navigator: Navigator, store: WaypointStore, limits: Limits, around: BatchContext
) -> int:
    """Run each line. Returns the exit code: 1 when a goal failed or a line could not be understood, else 0."""
    code = 0
    for line in lines:
        text = line.strip()
        try:
            command = parse_command(text)
            if isinstance(command, Quit):
                break
            if command is not None and not _run(command, text, navigator, store, limits, around):
                code = 1
        except UserError as problem:
            around.err(f"error: {text}: {error_line(problem)}")
            code = 1
    return code


def result_line(text: str, report: GoalReport, snapshot: Snapshot, seconds: float) -> str:
    """Describe the end of a goal: `g 2 3 90: reached, 0.04 m and 1.2 degrees off, 12.3 s`."""
    goal, pose = report.place, snapshot.pose
    if report.state is GoalState.REACHED and goal is not None and pose is not None:
        off = math.hypot(goal.x - pose.x, goal.y - pose.y)
        turned = math.degrees(abs(wrap_angle(goal.yaw - pose.yaw)))
        return f"{text}: reached, {off:.2f} m and {turned:.1f} degrees off, {seconds:.1f} s"
    why = f": {report.text}" if report.text else ""
    return f"{text}: {report.state.value} after {seconds:.1f} s{why}"


def _run(
    command: _AtOnce | _Awaited,
    text: str,
    navigator: Navigator,
    store: WaypointStore,
    limits: Limits,
    around: BatchContext,
) -> bool:
    """Run a command and return whether it succeeded. Raises UserError."""
    match command:
        case Go() | GoTo():
            return _drive(command, text, navigator, store, limits, around)
        case AskLease():
            return _ask_lease(command.request, text, navigator, limits, around)
        case AskMux():
            return _ask_mux(command.request, text, navigator, around)
        case SaveMap():
            if around.save is None:
                raise bad_command_error(NO_MAPPING)
            around.out(f"{text}: {around.save()}")
            return True
        case _:
            around.out(_do_at_once(command, text, navigator, store))
            return True


def _ask_mux(request: MuxRequest, text: str, navigator: Navigator, around: BatchContext) -> bool:
    """Send a request to the mux and return whether it took effect; an emergency stop ends the goal, too."""
    deadline = around.clock() + _ANSWER_WAIT
    if request == "stop":
        navigator.stop()
    navigator.ask_mux(request)
    while (mux := navigator.snapshot().mux).asked is not None and around.clock() < deadline:
        if around.sleep(0.02):
            raise InterruptedBatchError
    late = f"no answer within {_ANSWER_WAIT:g} s" if mux.asked is not None else ""
    done = "emergency stop" if request == "stop" else "released"
    around.out(f"{text}: {mux.problem or late or done}")
    return not (mux.problem or late)


def _ask_lease(request: DriverRequest, text: str, navigator: Navigator, limits: Limits, around: BatchContext) -> bool:
    """Send a request and return whether it took effect in time; `ask` waits longer, for a person's answer."""
    wait = limits.start if request == "ask" else _ANSWER_WAIT
    deadline = around.clock() + wait
    navigator.request_lease(request)
    while navigator.snapshot().lease.mine is (request == "grant"):
        if around.clock() >= deadline:
            around.out(f"{text}: not done within {wait:g} s{_who_drives(navigator.snapshot())}")
            return False
        if around.sleep(0.05):
            raise InterruptedBatchError
    around.out(f"{text}: {'handed over' if request == 'grant' else 'drives now'}")
    return True


def _who_drives(snapshot: Snapshot) -> str:
    reason = reason_not_to_drive(snapshot)
    return f": {reason}" if reason else ""


def _do_at_once(command: _AtOnce, text: str, navigator: Navigator, store: WaypointStore) -> str:
    """Run a command that ends at once and return its result line. Raises UserError."""
    match command:
        case Remember():
            pose = navigator.snapshot().pose
            assert pose is not None, "waited for before the first line"
            fresh = store.remember(command.name, pose)
            return f"{text}: {'saved at' if fresh else 'moved to'} {format_place(pose)}"
        case Forget():
            store.forget(command.name)
            return f"{text}: deleted"
        case ListPlaces():
            places = (f"{name}: {format_place(place)}" for name, place in store.places().items())
            return "\n".join(places) or f"{text}: no waypoints yet"
        case Stop():
            navigator.stop()
            return f"{text}: stopped"
        case Resume():
            raise bad_command_error("no goal to continue; commands run one at a time")
        case SetPose() | Relocalise():
            return _localise(command, text, navigator)
        case Follow() | SwitchTheme():
            raise bad_command_error("there is no map to show, expected a terminal for this command")
        case Help():
            return "\n".join(f"{usage:<14} {meaning}" for usage, meaning in USAGE.values())


def _localise(command: SetPose | Relocalise, text: str, navigator: Navigator) -> str:
    if reason := reason_not_to_drive(navigator.snapshot()):
        raise bad_command_error(f"not done: {reason}")
    if isinstance(command, SetPose):
        navigator.set_pose(Pose2(command.x, command.y, command.yaw))
        return f"{text}: pose set"
    navigator.relocalise()
    return f"{text}: searching for the robot on the whole map"


def _drive(
    command: Go | GoTo, text: str, navigator: Navigator, store: WaypointStore, limits: Limits, around: BatchContext
) -> bool:
    place = target_of(command, navigator.snapshot(), store)
    if reason := _wait_for_result(navigator, limits, around):
        around.out(f"{text}: not sent: {reason}")
        return False
    start = around.clock()
    number, noted = navigator.go(place), ""
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
            _run_urgent(typed, navigator, around)
        if ended := _give_up(snapshot, seconds, limits, attended=around.urgent is not None):
            navigator.stop()
            around.out(f"{text}: {ended}")
            return False
        noted = _note(text, snapshot, noted, around)
        if around.sleep(0.05):
            raise InterruptedBatchError(_cancel(navigator, around))
    around.out(result_line(text, report, snapshot, seconds))
    return report.state is GoalState.REACHED


def _wait_for_result(navigator: Navigator, limits: Limits, around: BatchContext) -> str:
    """Wait while the robot is silent or decides about a lost lease. Returns why the goal cannot be sent, or nothing."""
    deadline = around.clock() + limits.start
    while _is_undecided(snapshot := navigator.snapshot()) and around.clock() < deadline:
        if around.sleep(0.05):
            raise InterruptedBatchError
    return reason_not_to_drive(snapshot)


def _is_undecided(snapshot: Snapshot) -> bool:
    lease = snapshot.lease
    return snapshot.silence is not None or (lease.lost_by_other and lease.pending)


def _run_urgent(command: Command, navigator: Navigator, around: BatchContext) -> None:
    """Run a command that was typed while a goal is driven."""
    if isinstance(command, AskMux):
        _ask_mux(command.request, "emergency" if command.request == "stop" else "release", navigator, around)
    elif isinstance(command, Resume):
        navigator.resume()
    else:
        navigator.stop()


def _give_up(snapshot: Snapshot, seconds: float, limits: Limits, *, attended: bool) -> str:
    """Return the reason to stop waiting for the goal; empty while there is none."""
    if snapshot.goal.state is GoalState.ASKING and not attended:
        return f"stopped after {seconds:.1f} s: held, and a pipe cannot answer whether it goes on"
    silent = silence_line(snapshot)
    if seconds > limits.goal:
        limit = f"not reached after {seconds:.0f} s, the limit (parameter ~goal_timeout)"
        return f"unknown: {limit}; {silent}" if silent else f"failed: {limit}; stopped"
    if snapshot.silence is not None and snapshot.silence.seconds > limits.start:
        return f"unknown after {seconds:.1f} s: {silent}"
    return ""


def _note(text: str, snapshot: Snapshot, noted: str, around: BatchContext) -> str:
    """Report on standard error that the goal is held or unknown, or goes on, once for each change."""
    report = snapshot.goal
    if report.state in (GoalState.HELD, GoalState.ASKING, GoalState.UNKNOWN):
        if noted != report.state.value:
            unknown = f"{silence_line(snapshot)}; the goal is unknown until it answers"
            question = "held: the robot waits for you; c continues, x cancels"
            says = {GoalState.HELD: report.text, GoalState.ASKING: question}.get(report.state, unknown)
            around.err(f"note: {text}: {says}")
        return str(report.state.value)
    if noted and report.state is GoalState.DRIVING:
        around.err(f"note: {text}: driving")
        return ""
    return noted


def _cancel(navigator: Navigator, around: BatchContext) -> str:
    """Cancel the goal, and what is known of that."""
    navigator.stop()
    deadline = around.clock() + _CANCEL_WAIT
    while not (snapshot := navigator.snapshot()).goal.over and around.clock() < deadline:
        around.sleep(0.02)
    if snapshot.goal.over:
        return "the goal was cancelled"
    return f"the goal may not be cancelled: {silence_line(snapshot) or 'no answer'}"


def target_of(command: Go | GoTo, snapshot: Snapshot, store: WaypointStore) -> Pose2:
    """The pose a command asks for. Raises UserError: no such waypoint."""
    if isinstance(command, GoTo):
        return store.find(command.name)
    yaw = heading_there(snapshot, command.x, command.y) if command.yaw is None else command.yaw
    return Pose2(command.x, command.y, yaw)
