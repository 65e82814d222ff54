"""The mux of velocity commands: replaces twist_mux, with the emergency stop and the limits of the base."""

import math
import os
import sys
from collections.abc import Callable
from functools import partial

from ur.source.diagnostic import UserError, error
from ur_nodes.motion.admission.gate import AdmissionGate
from ur_nodes.motion.mux import MuxState, start_mux
from ur_nodes.motion.mux_events import EmergencyReleased, EmergencyStopped, Event, Source, SpeedLimited
from ur_nodes.motion.mux_runner import MuxRunner
from ur_nodes.motion.mux_settings import LEAST_LIMIT, LIMIT, STOPPED, read_limit, read_settings, read_share
from ur_nodes.motion.obstacle_stop.obstacle_stop import ObstacleStop
from ur_nodes.motion.writes import AsideLog, Writes
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Result
from ur_nodes.run import run


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


_OUTPUT = "cmd_vel_out"


def start(node: Node) -> None:
    """Read the parameters and connect. Raises UserError."""
    if node.parameters.boolean("real_base", False) and node.facts.simulated_time:
        message = "use_sim_time is true, expected false: a real base must stop in real time, however slow /clock is"
        raise UserError(error(message, rule="simulated-time", help="rosparam set /use_sim_time false"))
    settings = read_settings(node.parameters)
    if settings.slowed:
        node.log.warn(settings.slowed)
    if settings.stopped:
        node.log.warn(f"emergency stop is still on; call {node.resolve('~release')} to end it")
    for source in settings.mux.sources:
        if source.foreign and node.resolve(source.topic) == node.resolve(_OUTPUT):
            node.parameters.fail("takes_over", source.topic, f"another topic than that of the base, {_OUTPUT}")
    active = node.publish("~active", str, Quality.LATCHED)
    stopped = node.publish("~stopped", bool, Quality.LATCHED)

    def publish_state(state: MuxState) -> None:
        active.send(state.active_name)
        stopped.send(state.stopped)

    def report_output(state: MuxState) -> None:
        obstacle_stop.note(state.verdict, state.wanted, state.output)
        gate.note_output(more=math.isfinite(state.next_at))

    first = start_mux(settings.mux, stopped=settings.stopped, share=settings.share)
    runner = MuxRunner(node, first, _OUTPUT, publish_state, report_output)
    writes = Writes(node)
    obstacle_stop = ObstacleStop(
        node,
        settings.base,
        runner.guard,
        writes,
        on=settings.obstacle_stop,
        sonars=settings.sonars,
        lag=settings.mux.lag,
    )
    gate = AdmissionGate(
        node,
        settings.mux,
        runner.handle,
        writes,
        os.environ,
        rate=settings.challenge_rate,
        freshness=settings.freshness,
        lease_timeout=settings.lease_timeout,
    )
    MuxControls(node, runner, settings.mux.sources, settings.share, writes)


def main() -> int:
    """Run until shutdown. Returns the exit code."""
    return run("cmd_vel_mux", start)


if __name__ == "__main__":
    sys.exit(main())
