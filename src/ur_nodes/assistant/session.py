"""The robot's end of `ur mcp`: what an assistant sees of the robot, and what it asks of it."""

import base64
import math
import os
from collections.abc import Mapping
from typing import Protocol

import numpy as np

from ur.source.foreign.json_values import convert_json
from ur.worlds.drawing import write_png
from ur_nodes.assistant.messages import DriveCall, ExploreCall, GoCall, LifeSign, LookCall, Message, SetGrant, StopCall
from ur_nodes.assistant.motion import AssistedDriving
from ur_nodes.client.driver_text import describe_driver
from ur_nodes.client.mux import MuxLink, describe_emergency
from ur_nodes.client.navigation import Names, NavigationTopics
from ur_nodes.geometry.grid import Grid
from ur_nodes.motion.lease.view import identify, view_lease
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Battery

_PROGRAM = "assistant"
_MOST_PIXELS = 2000
_WALL, _UNKNOWN, _FREE = 0, 128, 255


class AnswerOutlet(Protocol):
    """Sends JSON to the server without letting the node wait."""

    def send_line(self, value: Mapping[str, object]) -> None:
        """Send a line of JSON."""


class AssistantSession:
    """Answers each message that has an id with `id`, `ok` and `text` or values; reports `revoked` by itself."""

    def __init__(self, node: Node, outlet: AnswerOutlet, names: Names | None = None) -> None:
        names = names or Names()
        self._outlet = outlet
        self._identity = identify({**os.environ, "UR_CLIENT": "", "UR_LEASE": "watch"}, _PROGRAM)
        self._topics, self._mux = NavigationTopics(node, names), MuxLink(node, names.mux)
        self._driving = AssistedDriving(
            node,
            names.mux,
            self._topics,
            self._mux,
            self._identity,
            self._answer,
            self._report_end,
            self._pass_challenge,
        )
        self._battery: Battery | None = None
        node.subscribe("battery_state", Battery, self._on_battery)

    def handle(self, message: Mapping[str, object]) -> None:
        """Take a message of the server. Raises BadJsonError."""
        found: Message = convert_json(message, Message)
        match found:
            case LifeSign():
                self._driving.beat(found.n)
            case SetGrant():
                self._driving.set_grant(found.grant)
            case DriveCall() | GoCall() | ExploreCall():
                self._driving.begin(found)
            case StopCall():
                self._driving.stop()
            case LookCall():
                self._outlet.send_line({"id": found.id, "ok": True, "values": self._describe(picture=found.picture)})

    def _describe(self, *, picture: bool) -> dict[str, object]:
        """The robot as values: m, m, degrees; None for what is not known."""
        seen, driving = self._topics.snapshot(), self._driving
        view = view_lease(driving.lease, self._identity.client, None, driving.link.link_age())
        pose, grant = seen.pose, driving.grant
        values: dict[str, object] = {
            "pose": [round(pose.x, 2), round(pose.y, 2), round(math.degrees(pose.yaw))] if pose else None,
            "speed": round(seen.speed, 2),
            "nearest": _list_nearest(seen.scan, pose.x, pose.y, pose.yaw) if seen.scan is not None and pose else None,
            "goal": seen.goal.state.value,
            "plan": seen.path[:: max(1, len(seen.path) // 50)].round(2).tolist() if seen.path is not None else None,
            "battery": None if self._battery is None else _finite(self._battery.voltage, self._battery.fraction),
            "driver": "you" if view.mine else describe_driver(view, hint="it has to let go first"),
            "emergency stop": describe_emergency(self._mux.view(), "a person has to release it"),
            "waiting for": list(seen.missing),
            "lost": seen.lost,
            "grant": grant.text if grant else None,
        }
        if picture:
            values["map"] = _draw(seen.grid) if seen.grid is not None else None
        return values

    def _on_battery(self, battery: Battery) -> None:
        self._battery = battery

    def _answer(self, id: int, ok: bool, text: str) -> None:
        self._outlet.send_line({"id": id, "ok": ok, "text": text})

    def _pass_challenge(self, challenge: int) -> None:
        self._outlet.send_line({"challenge": challenge})

    def _report_end(self, reason: str) -> None:
        self._outlet.send_line({"revoked": reason})


def _finite(*values: float) -> list[float | None]:
    return [round(each, 3) if math.isfinite(each) else None for each in values]


def _list_nearest(
    points: np.ndarray[tuple[int, ...], np.dtype[np.float64]], x: float, y: float, yaw: float
) -> dict[str, float]:
    """The distance (m) from the robot to what is nearest in eight directions of 45 degrees, to the left of ahead."""
    away = points - np.array([x, y])
    sectors = np.round((np.arctan2(away[:, 1], away[:, 0]) - yaw) / (math.pi / 4.0)).astype(int) % 8
    ranges = np.hypot(away[:, 0], away[:, 1])
    return {f"{45 * each} degrees": round(float(ranges[sectors == each].min()), 2) for each in np.unique(sectors)}


def _draw(grid: Grid) -> dict[str, object]:
    """The map as a PNG file with y up: `resolution` in m for each pixel, `origin` is its lower left corner."""
    step = max(1, math.ceil(max(grid.shape) / _MOST_PIXELS))
    values = grid.values[::-step, ::step]
    levels = np.where(values < 0, _UNKNOWN, np.where(values >= 50, _WALL, _FREE)).astype(np.uint8)
    origin = [round(float(each), 3) for each in grid.origin[:2]]
    picture = base64.b64encode(write_png(levels)).decode()
    return {"png": picture, "resolution": grid.resolution * step, "origin": origin, "size": list(levels.shape[::-1])}
