"""The emergency stop of a mux, its obstacle stop, and the source that drives, as user interfaces see them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

from ur_nodes.motion.obstacle_stop.report import Report
from ur_nodes.teleop.terminal.keys import Key, KeyEvent

MuxRequest = Literal["stop", "release", "obstacles on", "obstacles off"]

EMERGENCY_KEYS: dict[str, MuxRequest] = {"space": "stop", "r": "release"}
OBSTACLE_KEY = "g"

NO_REPORT = Report()
_IDLE = "idle"
_REFUSALS: dict[MuxRequest, str] = {
    "stop": "NOT STOPPED",
    "release": "not released",
    "obstacles on": "the obstacle stop is not turned on",
    "obstacles off": "the obstacle stop is not turned off",
}


@dataclass(frozen=True, slots=True)
class MuxView:
    """The newest state of the mux.

    `stopped` is None while no mux publishes it; `active` is the source that drives, empty for none; `asked` is what
    was asked of it and not answered yet; `problem` is why the last request failed, from `describe_refusal`;
    `obstacles` is the state of the obstacle stop.
    """

    stopped: bool | None = None
    active: str = ""
    asked: MuxRequest | None = None
    problem: str = ""
    obstacles: Report = NO_REPORT


class Emergency(Protocol):
    """A mux that can be asked to stop. No call blocks; what came of it is in later views."""

    def view(self) -> MuxView:
        """Return the newest state."""

    def ask(self, request: MuxRequest) -> None:
        """Stop everything that drives, release the emergency stop, or turn the obstacle stop on or off."""


def mux_request_of(event: KeyEvent) -> MuxRequest | None:
    """Return the request to the mux that a key makes; None for any other key."""
    if not isinstance(event, Key) or event.action != "press" or event.ctrl:
        return None
    return EMERGENCY_KEYS.get(event.name)


def obstacle_request_of(event: KeyEvent, view: MuxView) -> MuxRequest | None:
    """Return the request that turns the obstacle stop on or off; None for any other key, or without one."""
    pressed = isinstance(event, Key) and event.action == "press" and not event.ctrl and event.name == OBSTACLE_KEY
    if not pressed or view.obstacles.state == "none":
        return None
    return "obstacles on" if view.obstacles.state == "off" else "obstacles off"


def describe_obstacles(view: MuxView, turn_on: str = "") -> str:
    """Describe what the obstacle stop does, empty while nothing is in the way. `turn_on` tells how to turn it on."""
    report = view.obstacles
    if report.state == "off":
        return f"{report.text}{turn_on}"
    return report.text if report.state in ("slowed", "stopped") else ""


def view_of(
    connected: bool,
    stopped: bool | None,
    active: str,
    asked: MuxRequest | None,
    problem: str,
    obstacles: Report = NO_REPORT,
) -> MuxView:
    """The view of a mux: its last state counts only while it exists."""
    if not connected:
        return MuxView(asked=asked, problem=problem)
    return MuxView(stopped, "" if active == _IDLE else active, asked, problem, obstacles)


def describe_refusal(request: MuxRequest, reason: str) -> str:
    """Describe a request to the mux that had no effect, for `MuxView.problem`."""
    return f"{_REFUSALS[request]}: {reason}"


def describe_emergency(view: MuxView, release: str) -> str:
    """Describe an emergency in one line, empty when there is none. `release` describes how an emergency is ended."""
    if view.problem:
        return view.problem
    if view.stopped:
        return f"EMERGENCY STOP: {release}"
    if view.asked == "stop":
        return "emergency stop requested, no answer yet"
    return ""
