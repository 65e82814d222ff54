"""A mux for user interfaces: its emergency stop, its obstacle stop, and the active source."""

from dataclasses import dataclass, replace
from typing import Literal, Protocol

from ur_nodes.motion.obstacle_stop.report import ObstacleReport, read_report
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Switch, Trigger
from ur_nodes.ports.values import Result

MuxRequest = Literal["stop", "release", "obstacles on", "obstacles off"]

NO_REPORT = ObstacleReport()
_WITHIN = 2.0  # s for an answer
_STOP_WITHIN = 60.0  # s: a stop takes effect late rather than not at all
_PATIENCE = 1.0  # s: then a request that is made again is sent again
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
    obstacles: ObstacleReport = NO_REPORT


class EmergencyStop(Protocol):
    """A mux with an emergency stop. No call blocks; the result is in later views."""

    def view(self) -> MuxView:
        """Return the newest state."""

    def ask(self, request: MuxRequest) -> None:
        """Request an emergency stop, its release, or the obstacle stop on or off."""


class MuxLink:
    """The mux of a robot: see `EmergencyStop`. `ask` may come from any thread."""

    def __init__(self, node: Node, mux: str) -> None:
        """`mux` is the name of the node that offers `stop`, `release` and `set_obstacle_stop`."""
        self._node, self._mux = node, mux
        self._view = MuxView()
        self._asked_at = 0.0
        self._number = 0
        self._stopped = node.subscribe(f"{mux}/stopped", bool, self._on_stopped, Quality.LATCHED)
        node.subscribe(f"{mux}/active", str, self._on_active, Quality.LATCHED)
        node.subscribe(f"{mux}/obstacle_stop", str, self._on_obstacles, Quality.LATCHED)

    def view(self) -> MuxView:
        """Return the newest state."""
        view = self._view
        return view if self._stopped.publishers() else MuxView(asked=view.asked, problem=view.problem)

    def ask(self, request: MuxRequest) -> None:
        """Request an emergency stop, its release, or the obstacle stop on or off."""
        self._node.post(lambda: self._ask(request))

    def _ask(self, request: MuxRequest) -> None:
        now = self._node.steady()
        if self._view.asked == request and now - self._asked_at < _PATIENCE:
            return
        self._asked_at = now
        self._view = replace(self._view, asked=request, problem="")
        self._number += 1
        number, emergency = self._number, request in ("stop", "release")
        service = f"{self._mux}/{request if emergency else 'set_obstacle_stop'}"
        value = Trigger() if emergency else Switch(request == "obstacles on")
        within = _STOP_WITHIN if request == "stop" else _WITHIN
        self._node.call(service, value, lambda result: self._on_answer(number, request, service, result), within)
        if request == "stop":
            self._node.after(_WITHIN, lambda: self._report_silence(number, service), steady=True)

    def _report_silence(self, number: int, service: str) -> None:
        """Report that a stop is not answered; it is sent on all the same."""
        if number == self._number and self._view.asked == "stop":
            self._view = replace(
                self._view,
                asked=None,
                problem=self._describe_failure("stop", service, f"no answer within {_WITHIN:g} s"),
            )

    def _describe_failure(self, request: MuxRequest, service: str, text: str) -> str:
        reason = f": {text}" if self._stopped.publishers() else " does not answer: is the robot running?"
        return describe_refusal(request, f"service {self._node.resolve(service)}{reason}")

    def _on_answer(self, number: int, request: MuxRequest, service: str, result: Result) -> None:
        if number != self._number:
            return  # asked for something else since
        if not result.success:
            problem = self._describe_failure(request, service, result.text)
            self._view = replace(self._view, asked=None, problem=problem)
        elif request in ("stop", "release"):
            self._view = replace(self._view, asked=None, problem="", stopped=request == "stop")
        else:
            self._view = replace(self._view, asked=None, problem="")

    def _on_stopped(self, stopped: bool) -> None:
        self._view = replace(self._view, stopped=stopped)

    def _on_active(self, active: str) -> None:
        self._view = replace(self._view, active="" if active == _IDLE else active)

    def _on_obstacles(self, text: str) -> None:
        self._view = replace(self._view, obstacles=read_report(text) or NO_REPORT)


def describe_obstacles(view: MuxView, turn_on: str = "") -> str:
    """Describe what the obstacle stop does, empty while nothing is in the way. `turn_on` is how to turn it on."""
    report = view.obstacles
    if report.state == "off":
        return f"{report.text}{turn_on}"
    return report.text if report.state in ("slowed", "stopped") else ""


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
