"""A robot's end of the page on a bus, with the mux of the robot, and pages that drive it."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml
from tests.fakes.navigation import FakeNavigation

from ur.web.wire.frames import Kind, Layer, key_of
from ur_nodes.memory.bus import Bus
from ur_nodes.motion.cmd_vel_mux_node import start
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Twist
from ur_nodes.web.robot_endpoint import RobotSession

ROOT = Path(__file__).parents[3]
SOURCES = yaml.safe_load((ROOT / "ubiquity_launches/n_cmd_vel_mux/params/sources.yaml").read_text())


class Outlet:
    """A server that takes all that is sent, or, while it is `busy`, as much as is sent all the same."""

    def __init__(self) -> None:
        self.busy = False
        self.frames: list[bytes] = []
        self.take_line: Callable[[Any], None] = lambda _: None

    def send_frame(self, frame: bytes) -> None:
        self.frames.append(frame)

    def send_line(self, value: Any) -> None:
        self.take_line(json.loads(json.dumps(value)))

    def newest(self, kind: Kind, layer: Layer = Layer.NONE) -> Any:
        """The newest JSON of a kind."""
        return next(json.loads(each[6:]) for each in reversed(self.frames) if key_of(each)[:2] == (kind, layer))


class RobotWorld:
    """A robot with a mux and navigation, and its end of the page; `speeds` reach the base: times (ns) and velocities.

    `ROS_HOME` is where the mux keeps the lease.
    """

    def __init__(self, delay: Callable[[str], int | None] | None = None, **parameters: Any) -> None:
        self.bus = Bus(delay)
        self.bus.load_parameters("/cmd_vel_mux", {"base": "stage", **SOURCES, **parameters})
        self.bus.facts |= {"base_name": "stage", "variant": ""}
        self.speeds: list[tuple[int, Twist]] = []
        self.base, self.robot = self.bus.node("base"), self.bus.node("robot")
        self.base.subscribe(
            "cmd_vel_out", Twist, lambda twist: self.speeds.append((self.bus.now, twist)), Quality.EVERY
        )
        self.navigation = FakeNavigation(self.robot)
        self.mux = self.bus.node("cmd_vel_mux")
        self.mux.facts.simulated_time = False
        start(self.mux)
        self.node = self.bus.node("web")
        self.view, self.drive = Outlet(), Outlet()
        self.drive.take_line = self._on_line
        self.end = RobotSession(self.node, self.view, self.drive)
        self.challenge = [0, 0]
        self.pages: dict[str, DrivingPage] = {}
        self.bus.run(1.5)

    def _on_line(self, line: dict[str, Any]) -> None:
        if "n" in line:
            self.challenge = line["n"]
        else:
            self.pages[line["page"]].answers.append(line["m"])

    def forward(self, seconds: float) -> list[float]:
        """What reaches the base from now on, m/s ahead."""
        self.speeds.clear()
        self.bus.run(seconds)
        return [twist.forward for _, twist in self.speeds]

    def state(self) -> dict[str, Any]:
        """The newest state that pages have, after a moment."""
        self.end.on_view({"viewers": 1})
        self.bus.run(1.0)
        found: dict[str, Any] = self.view.newest(Kind.STATE)
        return found


class DrivingPage:
    """A page that may drive, and that says ten times a second that it is there, while it is `alive`."""

    def __init__(self, world: RobotWorld, client: str = "web-a", computer: str = "browser", **more: Any) -> None:
        self.world, self.client = world, client
        self.answers: list[dict[str, Any]] = []
        self.wanted: tuple[int, float, float] | None = None
        self.alive = True
        world.pages[client] = self
        world.end.on_drive({"do": "come", "page": client, "name": client, "computer": computer, **more})
        world.robot.every(0.1, lambda: self.ask("alive") if self.alive else None)
        world.robot.every(0.05, self._send_stick)

    def ask(self, request: str, *, late: bool = False, **more: Any) -> None:
        """Send a request that answers the newest challenge, or none of the last second."""
        answers = [1, 1] if late else self.world.challenge
        message = json.dumps({"t": request, "n": answers, **more})
        self.world.end.on_drive({"page": self.client, "m": message})

    def told(self, seconds: float = 0.5) -> list[dict[str, Any]]:
        """The answers since the last time, after a moment."""
        self.world.bus.run(seconds)
        found, self.answers = self.answers, []
        return found

    def leave(self) -> None:
        """The page is closed."""
        self.alive, self.wanted = False, None
        self.world.end.on_drive({"do": "leave", "page": self.client})

    def _send_stick(self) -> None:
        if self.wanted is not None:
            hold, forward, turn = self.wanted
            self.ask("stick", hold=hold, forward=forward, turn=turn)
