"""A mux that does what it is asked at once."""

import json
from collections.abc import Callable
from typing import Any

from ur_nodes.memory.bus import Bus
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Switch, Trigger
from ur_nodes.ports.values import Result, StampedTwist, Time, Twist


class FakeMux:
    """Notes what it is asked, publishes the lease that the test wants, and passes commands on that are in time.

    With `callback`, which gets those commands, it issues challenges at 30 Hz unless it is `mute`.
    """

    def __init__(self, bus: Bus, callback: Callable[[Twist], None] | None = None) -> None:
        self.asked: list[str] = []
        self.mute = False
        self.newest = 0  # ns
        self._bus, self._pass_on = bus, callback
        node = bus.node("cmd_vel_mux")
        self._stopped = node.publish("cmd_vel_mux/stopped", bool, Quality.LATCHED)
        self._stopped.send(False)
        node.serve("cmd_vel_mux/stop", Trigger, lambda _: self._answer("stop", stopped=True))
        node.serve("cmd_vel_mux/release", Trigger, lambda _: self._answer("release", stopped=False))
        node.serve("cmd_vel_mux/set_obstacle_stop", Switch, lambda request: self._answer(f"obstacles {request.on}"))
        if callback is not None:
            self._challenges = node.publish("cmd_vel_mux/challenge", Time)
            self._lease = node.publish("cmd_vel_mux/lease", str, Quality.LATCHED)
            node.subscribe("cmd_vel_stamped", StampedTwist, self._take, Quality.EVERY)
            node.every(1 / 30, self._issue)

    def say(self, state: str, **changes: Any) -> None:
        """Publish a lease: who drives, or did."""
        laptop = {"client": "aa", "name": "laptop", "since": 50.0, "attended": True, "asking": []}
        self._lease.send(json.dumps({"state": state, **laptop, **changes}))
        self._bus.run(0.05)

    def _answer(self, request: str, *, stopped: bool | None = None) -> Result:
        self.asked.append(request)
        if stopped is not None:
            self._stopped.send(stopped)
        return Result(success=True)

    def _issue(self) -> None:
        if not self.mute:
            self.newest = self._bus.now + 10**12
            self._challenges.send(Time(self.newest))

    def _take(self, command: StampedTwist) -> None:
        assert self._pass_on
        if not command.frame and self.newest - command.stamp < 150_000_000:
            self._pass_on(command.twist)
