"""The emergency stop and the speed limit of a mux. Both are kept when the process ends."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ur_nodes.motion.mux_events import EmergencyReleased, EmergencyStopped, Event, Source, SpeedLimited
from ur_nodes.motion.mux_runner import MuxRunner
from ur_nodes.motion.mux_settings import LEAST_LIMIT, LIMIT, STOPPED, read_limit, read_share
from ur_nodes.motion.writes import AsideLog, Writes
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result


class MuxControls:
    """Offers `~stop`, `~release` and `~speed_limit`.

    A stop takes effect at once, and is answered after it is stored.
    """

    def __init__(
        self, node: Node, runner: MuxRunner, sources: tuple[Source, ...], share: float, writes: Writes
    ) -> None:
        self._node, self._runner, self._sources, self._writes = node, runner, sources, writes
        self._log = AsideLog(node)
        self._limit = node.publish("~speed_limit_in_force", float, Quality.LATCHED)
        self._limit.send(100.0 * share)
        node.subscribe("~speed_limit", float, self._on_limit)
        node.parameters.follow(read_limit, self._on_limit)
        node.serve_later("~stop", Trigger, lambda _, give: self._switch(EmergencyStopped(), give, stopped=True))
        node.serve_later("~release", Trigger, lambda _, give: self._switch(EmergencyReleased(), give, stopped=False))

    def _switch(self, event: Event, give: Callable[[Result], None], *, stopped: bool) -> None:
        state = self._runner.handle(event)
        waiting = [
            source.name
            for source, received in zip(self._sources, state.received, strict=True)
            if received.barred and not stopped
        ]
        hint = f"; {', '.join(waiting)} may drive after a pause" if waiting else ""
        text = "stopped" if stopped else f"released{hint}"

        def answer(problem: str) -> None:
            lost = f", but a mux that is started again will not know it: {problem}" if problem else ""
            give(Result(True, text + lost))

        self._writes.write(STOPPED, partial(self._node.parameters.keep, STOPPED, stopped), answer)

    def _on_limit(self, percent: float) -> None:
        """Limit all sources to a percentage of the base's speeds, as Nav2 does with `speed_limit`; 0: no limit."""
        share = read_share(percent)
        if share is None:
            expected = f"expected {LEAST_LIMIT:g} to 100, or 0 for none"
            self._log.warn(f"speed limit of {percent:g} percent ignored, {expected}")
            return
        self._runner.handle(SpeedLimited(share))
        self._writes.write(LIMIT, partial(self._node.parameters.keep, LIMIT, 100.0 * share))
        self._limit.send(100.0 * share)
