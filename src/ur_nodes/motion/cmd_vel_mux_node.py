"""The mux of velocity commands: replaces twist_mux, with the emergency stop and the limits of the base."""

from __future__ import annotations

import os
import sys

from ur.source.diagnostic import UserError, error
from ur_nodes.motion.admission.gate import AdmissionGate
from ur_nodes.motion.mux import MuxState, start_mux
from ur_nodes.motion.mux_controls import MuxControls
from ur_nodes.motion.mux_events import GuardChanged
from ur_nodes.motion.mux_runner import MuxRunner
from ur_nodes.motion.mux_settings import read_settings
from ur_nodes.motion.obstacle_stop.obstacle_stop import ObstacleStop
from ur_nodes.motion.writes import Writes
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.run import run

_OUTPUT = "cmd_vel_out"


def start(node: Node) -> None:
    """Read the parameters and connect. Raises UserError."""
    if node.parameters.boolean("real_base", False) and node.facts.simulated_time:
        message = "use_sim_time is true, expected false: a real base must stop in real time, however slow /clock is"
        raise UserError(error(message, rule="simulated-time", help="rosparam set /use_sim_time false"))
    settings = read_settings(node.parameters)
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
        wanted, output = state.wanted, state.output
        obstacle_stop.note(
            state.verdict, (wanted.forward, wanted.turn, wanted.left), (output.forward, output.turn, output.left)
        )

    first = start_mux(settings.mux, stopped=settings.stopped, share=settings.share)
    runner = MuxRunner(node, first, _OUTPUT, publish_state, report_output)
    writes = Writes(node)
    obstacle_stop = ObstacleStop(
        node,
        settings.base,
        lambda guard: runner.handle(GuardChanged(guard)),
        writes,
        on=settings.obstacle_stop,
        sonars=settings.sonars,
        lag=settings.mux.lag,
    )
    AdmissionGate(
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
