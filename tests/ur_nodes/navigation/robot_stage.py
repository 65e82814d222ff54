"""A robot made of mathematics, its mux and a client of `move_base`, which runs beside them on a bus.

The robot lives in two rooms with a door (the map); its odometry is right, its localisation too.
"""

import math
from pathlib import Path as FilePath
from typing import Any

import numpy as np
from tests.fakes.mux import FakeMux
from tests.ur_nodes.navigation.closed_loop import two_rooms

from ur.source.foreign.yaml_text import load_yaml
from ur.source.project import launch_library
from ur_nodes.geometry.pose import Pose2
from ur_nodes.memory.bus import Bus
from ur_nodes.navigation.move_base_node import start
from ur_nodes.ports.actions import Goal, GoalId, GoalState
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Map, Range, Result, Scan, StampedPose, Transform, Twist

BEAMS = 180
CONE, HEARD, THICK = 0.5, 3.0, 0.12  # a sonar: rad, m; the radius of a pillar, m
BLIND = {
    "global_costmap": {
        "obstacle_layer": {"observation_sources": ""},
        "inflation_layer": {"inflation_radius": 0.8, "cost_scaling_factor": 5.0},
    },
    "local_costmap": {"obstacle_layer": {"observation_sources": ""}, "sonar_layer": {"topics": ["sonars"]}},
    "GlobalPlanner": {"cost_factor": 1.5},
}
"""Parameters of a robot without a lidar, as in the launch file of move_base."""


class RobotStage:
    """The robot (20 Hz odometry, 10 Hz scans); with `mux` it takes only commands that answer a challenge in time.

    `mute`: the mux issues no challenges until it is let.
    """

    def __init__(self, *, mux: bool = False, mute: bool = False, parameters: dict[str, Any] | None = None) -> None:
        self.bus = Bus()
        file = FilePath(launch_library() / "n_move_base/params/stage.yaml")
        self.bus.load_parameters("/move_base", load_yaml(file.read_text(encoding="utf-8")))
        self.bus.load_parameters("/move_base", {"controller_patience": 1.0, **(parameters or {})})
        self.grid = two_rooms()
        self.occupied = self.grid.values >= 65
        self.pose = Pose2(0.0, 0.0, 0.0)
        self.command, self.commanded, self.commands = (0.0, 0.0), 0, 0
        self.seeing = self.moving_frames = True
        self.pillar: tuple[float, float] | None = None
        self.nearest = math.inf
        self.states: dict[str, GoalState] = {}
        self.reports: list[StampedPose] = []
        self._ticks = self._count = 0
        self.node = self.bus.node("robot")
        self._scans = self.node.publish("scan", Scan)
        self._sonar = self.node.publish("sonars", Range)
        self.maps = self.node.publish("map", Map, Quality.LATCHED)
        self.maps.send(Map(self.bus.now, "map", self.grid))
        self.node.every(0.05, self._live)
        self.mux = FakeMux(self.bus, self.take_command) if mux else None
        if self.mux:
            self.mux.mute = mute
        self.stops = self.node.publish("cmd_vel_mux/stopped", bool, Quality.LATCHED)
        if not mux:
            self.node.subscribe("cmd_vel", Twist, self.take_command, Quality.EVERY)
        self.client = self.bus.node("client")
        self._goals = self.client.publish("move_base/goal", Goal, Quality.EVERY)
        self._cancels = self.client.publish("move_base/cancel", GoalId, Quality.EVERY)
        self.client.subscribe("move_base/state", GoalState, self._take_state, Quality.EVERY)
        self.client.subscribe("move_base/feedback", StampedPose, self.reports.append)
        self.move_base = self.bus.node("move_base")
        start(self.move_base)
        self.bus.run(1.0 if mux else 5.5)  # without challenges goals are taken later

    def send(self, x: float, y: float, yaw: float = 0.0, frame: str = "map", id: str = "") -> str:
        """Send a goal; returns its id."""
        self._count += 1
        id = id or f"goal {self._count}"
        self._goals.send(Goal(id, StampedPose(self.bus.now, frame, Pose2(x, y, yaw))))
        return id

    def cancel(self, id: str) -> None:
        self._cancels.send(GoalId(id))

    def end(self, id: str, seconds: float = 60.0) -> tuple[str, str]:
        """Let a goal end; its state and text."""

        def ended() -> bool:
            return id in self.states and self.states[id].state not in ("pending", "active")

        assert self.bus.run_until(ended, seconds), f"{id} has not ended: {self.states.get(id)}, {self.pose}"
        return self.states[id].state, self.states[id].text

    def has_status(self, id: str, state: str, text: str, seconds: float = 20.0) -> bool:
        """Let time pass until a goal has a state with a text that begins like this."""

        def said() -> bool:
            found = self.states.get(id)
            return found is not None and found.state == state and found.text.startswith(text)

        return self.bus.run_until(said, seconds)

    def starts_moving(self) -> bool:
        return self.bus.run_until(lambda: self.command[0] > 0.2, 20.0)

    def stops_moving(self) -> bool:
        return self.bus.run_until(lambda: self.command == (0.0, 0.0), 5.0)

    def rests(self, seconds: float = 1.0) -> bool:
        """Let time pass; whether no command has come meanwhile."""
        before = self.commands
        self.bus.run(seconds)
        return self.commands == before

    def ask(self, service: str, request: object) -> Result:
        answers: list[Result] = []
        self.client.call(service, request, answers.append)
        assert self.bus.run_until(lambda: bool(answers), 10.0)
        return answers[0]

    def away(self, x: float, y: float) -> float:
        """The distance of the robot from a place, m."""
        return math.hypot(self.pose.x - x, self.pose.y - y)

    def take_command(self, twist: Twist) -> None:
        self.command, self.commanded = (twist.forward, twist.turn), self.bus.now
        self.commands += 1

    def _take_state(self, state: GoalState) -> None:
        self.states[state.id] = state

    def _live(self) -> None:
        if self.bus.now - self.commanded > 250_000_000:
            self.command = (0.0, 0.0)
        v, w = self.command
        middle = self.pose.yaw + w * 0.025
        self.pose = Pose2(
            self.pose.x + 0.05 * v * math.cos(middle),
            self.pose.y + 0.05 * v * math.sin(middle),
            self.pose.yaw + 0.05 * w,
        )
        now = self.bus.now
        if self.moving_frames:
            self.node.transforms.send(
                Transform(now, "map", "odom", Pose2(0.0, 0.0, 0.0).in_space()),
                Transform(now, "odom", "base_footprint", self.pose.in_space()),
            )
        if self.pillar and self._ticks % 2 == 0:
            self._sonar.send(self._listen(*self.pillar))
        if self.seeing and self._ticks % 2 == 0:
            self._scans.send(self._look())
        self._ticks += 1

    def _listen(self, x: float, y: float) -> Range:
        dx, dy = x - self.pose.x, y - self.pose.y
        away = math.hypot(dx, dy)
        self.nearest = min(self.nearest, away - THICK)
        off = abs(math.remainder(math.atan2(dy, dx) - self.pose.yaw, math.tau)) - math.atan2(THICK, away)
        heard = away - THICK if off < CONE / 2 and away - THICK < HEARD else math.inf
        return Range(self.bus.now, "base_footprint", heard, CONE, 0.02, HEARD)

    def _look(self) -> Scan:
        angles = np.arange(BEAMS) * math.tau / BEAMS - math.pi
        steps = np.arange(0.05, 4.0, 0.025)
        directions = np.stack((np.cos(angles + self.pose.yaw), np.sin(angles + self.pose.yaw)), axis=-1)
        cells = self.grid.cells_of_points((self.pose.x, self.pose.y) + steps[:, None] * directions[:, None])
        inside = self.grid.contains(cells)
        hit = self.occupied[np.where(inside, cells[..., 0], 0), np.where(inside, cells[..., 1], 0)] & inside
        ranges = np.where(hit.any(axis=1), steps[hit.argmax(axis=1)], math.inf).astype(np.float32)
        return Scan(self.bus.now, "base_footprint", -math.pi, math.tau / BEAMS, 0.05, 4.0, ranges)
