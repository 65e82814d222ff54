"""Commands without a terminal: one after another, one result line each."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from ur.source.diagnostic import UserError
from ur_nodes.teleop.commands import (
    USAGE,
    AskMux,
    Command,
    Forget,
    Go,
    GoTo,
    Help,
    ListPlaces,
    Quit,
    Relocalise,
    Remember,
    SetPose,
    Stop,
    error_line,
    parse_command,
)
from ur_nodes.teleop.emergency import Wish
from ur_nodes.teleop.navigator import (
    GoalReport,
    GoalState,
    Navigator,
    Place,
    Snapshot,
    angle_between,
    heading_there,
)
from ur_nodes.teleop.waypoints import WaypointStore

_ANSWER_WAIT = 5.0  # s: for the mux

Write = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Surroundings:
    """What a batch needs of the world: where lines go, and a clock. `sleep` returns True when the batch is to end."""

    out: Write
    err: Write
    clock: Callable[[], float]
    sleep: Callable[[float], bool]


@dataclass(frozen=True, slots=True)
class Limits:
    """Seconds: until map, pose and navigation are there, and for one goal."""

    start: float = 30.0
    goal: float = 600.0


class InterruptedBatchError(Exception):
    """The batch is to end now."""


def wait_until_ready(navigator: Navigator, limits: Limits, around: Surroundings) -> str | None:
    """Wait for everything a goal needs. Returns None, or what is still missing when the time is up."""
    deadline = around.clock() + limits.start
    while missing := navigator.snapshot().missing:
        if around.clock() >= deadline:
            return " and ".join(missing)
        if around.sleep(0.1):
            raise InterruptedBatchError
    return None


def run_batch(
    lines: Iterable[str], navigator: Navigator, store: WaypointStore, limits: Limits, around: Surroundings
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
    """How a goal ended: `g 2 3 90: reached, 0.04 m and 1.2 degrees off, 12.3 s`."""
    goal, pose = report.place, snapshot.pose
    if report.state is GoalState.REACHED and goal is not None and pose is not None:
        off = math.hypot(goal.x - pose.x, goal.y - pose.y)
        turned = math.degrees(angle_between(goal.yaw, pose.yaw))
        return f"{text}: reached, {off:.2f} m and {turned:.1f} degrees off, {seconds:.1f} s"
    why = f": {report.text}" if report.text else ""
    return f"{text}: {report.state.value} after {seconds:.1f} s{why}"


def _run(
    command: Command, text: str, navigator: Navigator, store: WaypointStore, limits: Limits, around: Surroundings
) -> bool:
    """Whether it went well. Raises UserError."""
    if isinstance(command, (Go, GoTo)):
        return _drive(command, text, navigator, store, limits, around)
    if isinstance(command, AskMux):
        return _ask_mux(command.wish, text, navigator, around)
    around.out(_do_at_once(command, text, navigator, store))
    return True


def _ask_mux(wish: Wish, text: str, navigator: Navigator, around: Surroundings) -> bool:
    """Whether the mux did it; with an emergency the goal ends, too."""
    deadline = around.clock() + _ANSWER_WAIT
    if wish == "stop":
        navigator.stop()
    navigator.ask_mux(wish)
    while (mux := navigator.snapshot().mux).asked is not None and around.clock() < deadline:
        if around.sleep(0.02):
            raise InterruptedBatchError
    late = f"no answer within {_ANSWER_WAIT:g} s" if mux.asked is not None else ""
    done = "emergency stop" if wish == "stop" else "released"
    around.out(f"{text}: {mux.problem or late or done}")
    return not (mux.problem or late)


def _do_at_once(command: Command, text: str, navigator: Navigator, store: WaypointStore) -> str:
    if isinstance(command, Remember):
        pose = navigator.snapshot().pose
        assert pose is not None, "waited for before the first line"
        fresh = store.remember(command.name, pose)
        return f"{text}: {'remembered' if fresh else 'moved to'} {place_text(pose)}"
    if isinstance(command, Forget):
        store.forget(command.name)
        return f"{text}: dropped"
    if isinstance(command, ListPlaces):
        places = store.places()
        return (
            "\n".join(f"{name}: {place_text(place)}" for name, place in places.items()) or f"{text}: no waypoints yet"
        )
    if isinstance(command, Stop):
        navigator.stop()
        return f"{text}: stopped"
    if isinstance(command, SetPose):
        navigator.set_pose(Place(command.x, command.y, command.yaw))
        return f"{text}: told the localiser"
    if isinstance(command, Relocalise):
        navigator.relocalise()
        return f"{text}: the localiser looks everywhere now"
    assert isinstance(command, Help)
    return "\n".join(f"{usage:<14} {meaning}" for usage, meaning in USAGE.values())


def _drive(
    command: Go | GoTo, text: str, navigator: Navigator, store: WaypointStore, limits: Limits, around: Surroundings
) -> bool:
    place = target_of(command, navigator.snapshot(), store)
    start = around.clock()
    number = navigator.go(place)
    while True:
        snapshot = navigator.snapshot()
        report, seconds = snapshot.goal, around.clock() - start
        if report.number > number:
            around.out(f"{text}: failed: another goal took its place after {seconds:.1f} s")
            return False
        if report.number == number and report.over:
            break
        if seconds > limits.goal:
            navigator.stop()
            around.out(
                f"{text}: failed: not reached after {seconds:.0f} s, the limit (parameter ~goal_timeout); stopped"
            )
            return False
        if around.sleep(0.05):
            navigator.stop()
            raise InterruptedBatchError
    around.out(result_line(text, report, snapshot, seconds))
    return report.state is GoalState.REACHED


def target_of(command: Go | GoTo, snapshot: Snapshot, store: WaypointStore) -> Place:
    """The pose a command asks for. Raises UserError: no such waypoint."""
    if isinstance(command, GoTo):
        return store.find(command.name)
    yaw = heading_there(snapshot, command.x, command.y) if command.yaw is None else command.yaw
    return Place(command.x, command.y, yaw)


def place_text(place: Place) -> str:
    """A pose for people: `1.20 3.40 90`, as `g` takes it."""
    return f"{place.x:.2f} {place.y:.2f} {math.degrees(place.yaw):.0f}"
