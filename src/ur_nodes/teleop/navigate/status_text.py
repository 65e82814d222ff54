"""The lines of text below the map: the state of the robot, and messages about goals and requests."""

import math
from collections.abc import Mapping
from dataclasses import replace

from rich.console import RenderableType
from rich.table import Table
from rich.text import Text

from ur_nodes.client.driver_text import DriverRequest, clock_time, describe_lost, describe_silence, name_holder
from ur_nodes.client.mux import describe_emergency, describe_obstacles
from ur_nodes.client.patrol_text import describe_patrol
from ur_nodes.client.snapshot import (
    ROBOT,
    LastGoalState,
    RobotSnapshot,
    describe_recoveries,
    distance_left,
    format_number,
    format_pose,
)
from ur_nodes.geometry.pose import Pose2
from ur_nodes.teleop.navigate.commands import MAP_USAGE, USAGE

REQUESTED: dict[DriverRequest, str] = {
    "take": "requested to drive from this computer",
    "ask": "asked the driving client to hand over",
    "grant": "handing over to the client that asked",
}
"""The message when the lease was requested."""


def announce_goal(snapshot: RobotSnapshot) -> tuple[str, str]:
    """Return the message about the state of the goal, and its style. The goal has a place."""
    report = snapshot.goal
    assert report.pose is not None
    where = format_pose(report.pose, any_heading=report.any_heading)
    if report.state is LastGoalState.REACHED and snapshot.pose is not None:
        off = math.hypot(report.pose.x - snapshot.pose.x, report.pose.y - snapshot.pose.y)
        return f"reached {where}, {report.text or f'{off:.2f} m off'}", "yellow" if report.text else "green"
    if report.state is LastGoalState.FAILED:
        return f"{where}: failed: {report.text}", "bold red"
    if report.state is LastGoalState.STOPPED:
        why = f": {report.text}" if report.text not in ("", "cancelled") else ""
        return f"stopped on the way to {where}{why}", "yellow"
    if report.state is LastGoalState.HELD:
        return f"held on the way to {where}", "yellow"
    if report.state is LastGoalState.UNKNOWN:
        return f"state of the goal {where} unknown", "yellow"
    return f"{'sent' if report.state is LastGoalState.WAITING else 'driving'} to {where}", ""


def describe_stop(snapshot: RobotSnapshot) -> str:
    """Return the message after the goal was cancelled by a command."""
    if silent := silence_line(snapshot):
        return f"stop requested, but there is {silent}"
    return "no goal to stop" if snapshot.goal.over else "stopped"


def visible_state(snapshot: RobotSnapshot, places: Mapping[str, Pose2], size: object) -> tuple[object, ...]:
    """Return everything that the screen depends on, rounded to visible differences."""
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
        snapshot.patrol,
        replace(snapshot.lease, link_age=0.0),
        (snapshot.silence.who, round(snapshot.silence.seconds, 1)) if snapshot.silence else None,
        tuple(places.items()),
        size,
    )


_SHOWN = {
    LastGoalState.NONE: ("○", "dim"),
    LastGoalState.WAITING: ("◌", "yellow"),
    LastGoalState.DRIVING: ("▶", "bold green"),
    LastGoalState.HELD: ("‖", "bold yellow"),
    LastGoalState.UNKNOWN: ("?", "bold yellow"),
    LastGoalState.REACHED: ("●", "bold green"),
    LastGoalState.STOPPED: ("■", "yellow"),
    LastGoalState.FAILED: ("✗", "bold red"),
}
_GAP = "  │  "
_WIDE = 70  # columns: room for hints
MAP_KEYS = (
    ("click", "drive there"),
    ("drag", "drive there, arrive facing that way"),
    ("wheel, + -", "zoom"),
    ("0", "show the whole map"),
    ("right drag, ← →", "move the map"),
    ("Tab", "letters are map keys: h j k l move, f t"),
    ("Space", "emergency stop; twice while you type"),
)


def status_line(snapshot: RobotSnapshot, columns: int) -> Text:
    """Return pose, speed, goal, distance left and localisation, as many as fit and are up to date."""
    if snapshot.silence is not None and snapshot.silence.who == ROBOT:
        lost = Text(silence_line(snapshot), "bold red")
        parts = [lost, None if snapshot.goal.over else _goal(snapshot)]
    else:
        parts = [_goal(snapshot), _pose(snapshot), _speed(snapshot), _spread(snapshot)]
    line = Text("", no_wrap=True, end="")
    for part in parts:
        if part is None:
            continue
        gap = _GAP if line.cell_len else ""
        if gap and line.cell_len + len(gap) + part.cell_len > columns:
            break
        line.append(gap, "dim")
        line.append_text(part)
    line.truncate(columns, overflow="ellipsis")
    return line


def alarm_line(snapshot: RobotSnapshot) -> str:
    """Describe an emergency stop, or that the robot is lost; empty otherwise."""
    return describe_emergency(snapshot.mux, "r and Enter let the robot drive again") or snapshot.lost


def silence_line(snapshot: RobotSnapshot) -> str:
    """Return the text about a sender that is silent, or ''."""
    silence = snapshot.silence
    return describe_silence(silence.who, silence.seconds) if silence else ""


def driver_line(snapshot: RobotSnapshot, columns: int) -> str:
    """Return the text about the driver, a request to drive, or obstacles; empty while this client drives or may."""
    obstacles = describe_obstacles(snapshot.mux)
    driver = _driver_line(snapshot, columns)
    return f"{driver}; {obstacles}" if driver and obstacles else driver or obstacles


def _driver_line(snapshot: RobotSnapshot, columns: int) -> str:
    view = snapshot.lease
    if line := _patrol_line(snapshot, columns):
        return line
    if view.mine:
        return f"{view.asking[0]} asks to drive; 'give' hands over" if view.asking else ""
    text = _describe_driver(snapshot)
    if not text or columns < _WIDE:
        return text
    if view.lost_by_other:
        return f"{text}; drive: take over"
    if view.state == "held":
        return f"{text}; asked to hand over" if view.asks else f"{text}; drive: take over, ask: ask for it"
    return text


def _patrol_line(snapshot: RobotSnapshot, columns: int) -> str:
    """Return the text about a patrol of any client that is active or paused."""
    patrol = snapshot.patrol
    if patrol is None or not (patrol.active or patrol.state == "paused"):
        return ""
    hint = "; patrol resume, patrol end" if patrol.state == "paused" else "; patrol pause, patrol end"
    return describe_patrol(patrol) + (hint if columns >= _WIDE else "")


def reason_not_to_drive(snapshot: RobotSnapshot) -> str:
    """Return the reason why this client must not send goals or set the pose, or ''."""
    view = snapshot.lease
    if snapshot.silence is not None and snapshot.silence.who == ROBOT:
        return silence_line(snapshot)
    if view.other:
        return f"{_describe_driver(snapshot)}; 'drive' takes over, 'ask' asks for it"
    if view.lost_by_other:
        return f"{_describe_driver(snapshot)}; 'drive' takes over"
    if snapshot.conduct == "watch" and not view.mine and view.state != "unknown":
        return "this program only monitors; 'drive' drives from this computer"
    return ""


def reason_not_to_send(snapshot: RobotSnapshot) -> str:
    """Return the reason why no goal can be sent now, or ''."""
    if reason := reason_not_to_drive(snapshot):
        return reason
    if snapshot.missing:
        return waiting_line(snapshot)
    return "the emergency stop is on; r and Enter let the robot drive again" if snapshot.mux.stopped else ""


def waiting_line(snapshot: RobotSnapshot) -> str:
    """Describe what is missing; empty when nothing is."""
    return f"waiting for {' and '.join(snapshot.missing)} ..." if snapshot.missing else ""


def help_table() -> RenderableType:
    """Make the table of commands and keys for the help panel; long texts wrap in their own column."""
    table = Table.grid(padding=(0, 2), pad_edge=False)
    table.add_column(no_wrap=True, style="cyan")
    table.add_column()
    for usage, meaning in (*USAGE.values(), *MAP_USAGE.values()):
        table.add_row(usage, meaning)
    table.add_row("", "")
    for keys, meaning in MAP_KEYS:
        table.add_row(keys, meaning)
    return table


def _describe_driver(snapshot: RobotSnapshot) -> str:
    view = snapshot.lease
    taken = f"{view.taken_by} took over at {clock_time(view.taken_at or view.since)}" if view.taken_by else ""
    if view.other:
        return taken or f"{name_holder(view)} drives since {clock_time(view.since)}"
    if view.lost_by_other:
        return describe_lost(view)
    if view.state == "free" and taken:
        return f"{taken} and has left"
    if view.state == "free" and snapshot.conduct == "watch":
        return f"{view.note or 'no client drives'}; 'drive' drives from this computer"
    return view.note if view.state == "free" else ""


def _pose(snapshot: RobotSnapshot) -> Text | None:
    pose = snapshot.pose
    if pose is None:
        return None
    return Text.assemble(
        ("x ", "dim"),
        format_number(pose.x, 2),
        ("  y ", "dim"),
        format_number(pose.y, 2),
        ("  ∠ ", "dim"),
        f"{format_number(math.degrees(pose.yaw), 0)}°",
    )


def _speed(snapshot: RobotSnapshot) -> Text | None:
    if snapshot.pose is None:
        return None
    return Text.assemble(f"{abs(snapshot.speed):.2f}", (" m/s", "dim"))


def _goal(snapshot: RobotSnapshot) -> Text:
    report = snapshot.goal
    sign, style = _SHOWN[report.state]
    if report.state is LastGoalState.UNKNOWN:
        return Text.assemble((f"{sign} goal unknown until it answers", style))
    held = report.state is LastGoalState.HELD
    text = Text.assemble((f"{sign} {(held and report.text) or report.state.value}", style))
    left = distance_left(snapshot)
    if not (report.over or held) and left is not None:
        text.append(f"  {left:.1f}").append(" m left", "dim")
    if recoveries := describe_recoveries(report):
        text.append(f"  {recoveries}", "yellow")
    return text


def _spread(snapshot: RobotSnapshot) -> Text | None:
    if snapshot.spread is None:
        return None
    style = "" if snapshot.spread < 0.25 else "yellow" if snapshot.spread < 0.6 else "bold red"
    return Text.assemble(("localised ± ", "dim"), (f"{snapshot.spread:.2f}", style), (" m", "dim"))
