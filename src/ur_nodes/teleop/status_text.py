"""The lines of words below the map."""

from __future__ import annotations

import math

from rich.text import Text

from ur_nodes.teleop.commands import USAGE
from ur_nodes.teleop.emergency import describe_emergency
from ur_nodes.teleop.navigator import GoalState, Snapshot, distance_left

_SHOWN = {
    GoalState.NONE: ("○", "dim"),
    GoalState.WAITING: ("◌", "yellow"),
    GoalState.DRIVING: ("▶", "bold green"),
    GoalState.REACHED: ("●", "bold green"),
    GoalState.STOPPED: ("■", "yellow"),
    GoalState.FAILED: ("✗", "bold red"),
}
_GAP = "  │  "

MAP_KEYS = (
    ("Space", "emergency stop; press it twice while you type"),
    ("+ - 0", "zoom in, out (or the wheel), the whole map"),
    ("f", "follow the robot"),
    ("arrows, h j k l", "move the map, or drag with the right button"),
    ("t", "dark or light"),
    ("Tab", "from the map to the command line and back"),
    ("click, drag", "drive there; face the way of the drag"),
)


def status_line(snapshot: Snapshot, columns: int) -> Text:
    """Pose, speed, goal, distance left, localisation: as many of them as fit."""
    parts = [_goal(snapshot), _pose(snapshot), _speed(snapshot), _spread(snapshot)]
    line = Text(" ", no_wrap=True, end="")
    for part in parts:
        if part is None:
            continue
        gap = _GAP if line.cell_len > 1 else ""
        if line.cell_len + len(gap) + part.cell_len > columns:
            break
        line.append(gap, "dim")
        line.append_text(part)
    return line


def alarm_line(snapshot: Snapshot) -> str:
    """What is to be known of an emergency, or nothing."""
    return describe_emergency(snapshot.mux, "r and Enter let the robot drive again")


def waiting_line(snapshot: Snapshot) -> str:
    """What is missing, or nothing."""
    return f"waiting for {' and '.join(snapshot.missing)} ..." if snapshot.missing else ""


def help_text() -> Text:
    """Commands and keys, for the help panel."""
    text = Text()
    text.append("commands\n", "bold")
    for usage, meaning in USAGE.values():
        text.append(f"  {usage:<16}", "cyan").append(f"{meaning}\n")
    text.append("\nmouse, and keys while the map or an empty line has the focus\n", "bold")
    for keys, meaning in MAP_KEYS:
        text.append(f"  {keys:<16}", "cyan").append(f"{meaning}\n")
    text.rstrip()
    return text


def _pose(snapshot: Snapshot) -> Text | None:
    pose = snapshot.pose
    if pose is None:
        return None
    return Text.assemble(
        ("x ", "dim"), f"{pose.x:.2f}", ("  y ", "dim"), f"{pose.y:.2f}", ("  ∠ ", "dim"), f"{_degrees(pose.yaw)}°"
    )


def _speed(snapshot: Snapshot) -> Text | None:
    if snapshot.pose is None:
        return None
    return Text.assemble(f"{abs(snapshot.speed):.2f}", (" m/s", "dim"))


def _goal(snapshot: Snapshot) -> Text:
    report = snapshot.goal
    sign, style = _SHOWN[report.state]
    text = Text.assemble((f"{sign} {report.state.value}", style))
    left = distance_left(snapshot)
    if not report.over and left is not None:
        text.append(f"  {left:.1f}").append(" m left", "dim")
    return text


def _spread(snapshot: Snapshot) -> Text | None:
    if snapshot.spread is None:
        return None
    style = "" if snapshot.spread < 0.25 else "yellow" if snapshot.spread < 0.6 else "bold red"
    return Text.assemble(("localised ± ", "dim"), (f"{snapshot.spread:.2f}", style), (" m", "dim"))


def _degrees(yaw: float) -> int:
    degrees = round(math.degrees(yaw))
    return 0 if degrees == 0 else degrees  # never -0
