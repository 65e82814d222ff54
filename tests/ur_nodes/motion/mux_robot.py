"""A mux on a bus, with clients and a base, for tests."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import yaml

from ur_nodes.memory.bus import Bus
from ur_nodes.memory.node import MemoryNode
from ur_nodes.motion.challenge.link import FreshPublisher
from ur_nodes.motion.cmd_vel_mux_node import start
from ur_nodes.motion.lease.client import LeaseClient
from ur_nodes.motion.lease.view import Conduct, Identity
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result, Twist

ROOT = Path(__file__).parents[3]
SOURCES = yaml.safe_load((ROOT / "ubiquity_launches/n_cmd_vel_mux/params/sources.yaml").read_text())
AHEAD = Twist(0.3, 0.0)
STILL = Twist(0.0, 0.0)


class LeaseDriver:
    """A client of the mux that sends commands at 50 Hz while `wanted` is set, each with the newest challenge."""

    def __init__(self, bus: Bus, name: str, conduct: Conduct = "drive", topic: str = "key_vel") -> None:
        self.node = bus.node(name)
        self.lease = LeaseClient(self.node, "cmd_vel_mux", identity=Identity(name, f"{name}-host", "test", conduct))
        self.fresh = FreshPublisher(topic, self.lease.link, name)
        self.wanted: Twist | None = None
        self.sent_at = 0
        self.node.every(0.02, self.send)

    def send(self) -> None:
        if self.wanted is not None and self.fresh.send(self.wanted):
            self.sent_at = self.node.now()


class MuxRobot:
    """A bus with a mux whose clock is a steady one, and what reaches the base: times (ns) and velocities."""

    def __init__(
        self,
        home: Path,
        delay: Callable[[str], int | None] | None = None,
        schemas: dict[str, str] | None = None,
        **parameters: Any,
    ) -> None:
        self.home = home
        self.bus = Bus(delay)
        self.bus.schemas |= schemas or {}
        own = {"base": "stage", **SOURCES, **parameters}
        self.bus.parameters |= {f"/cmd_vel_mux/{name}": value for name, value in own.items()}
        self.person = self.bus.node("person")
        self.outputs: list[tuple[int, Twist]] = []
        self.topics: dict[str, list[Any]] = {}
        take = lambda twist: self.outputs.append((self.bus.now, twist))  # noqa: E731
        self.base = self.bus.node("base")
        self.base.subscribe("cmd_vel_out", Twist, take, Quality.EVERY)
        self.mux = self.start()

    def start(self) -> MemoryNode:
        self.mux = self.bus.node("cmd_vel_mux")
        self.mux.facts.simulated_time = False
        start(self.mux)
        self.bus.run(0.1)
        return self.mux

    def kill(self) -> None:
        """The mux ends without any last word."""
        self.mux._at_end.clear()
        self.mux.end("killed")

    def ask(self, service: str, request: object | None = None) -> Result:
        got: list[Result] = []
        self.person.call(f"cmd_vel_mux/{service}", request or Trigger(), got.append)
        assert self.bus.run_until(lambda: bool(got), 10.0)
        return got[0]

    def newest(self, topic: str, kind: type[Any]) -> Any:
        got: list[Any] = []
        heard = self.person.subscribe(f"cmd_vel_mux/{topic}", kind, got.append, Quality.LATCHED)
        self.bus.run(0.001)
        heard.close()
        return got[-1]

    def speeds(self, seconds: float) -> list[float]:
        """What reaches the base from now on, m/s ahead."""
        del self.outputs[:]
        self.bus.run(seconds)
        return [twist.forward for _, twist in self.outputs]

    def plain(self, topic: str, name: str = "plain") -> Callable[[], None]:
        publisher = self.bus.node(name).publish(topic, Twist, Quality.EVERY)
        return lambda: publisher.send(AHEAD)
