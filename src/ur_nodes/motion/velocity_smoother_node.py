"""The node `velocity_smoother`: limits accelerations, in place of yujin's velocity smoother, as a mux of one source.

A base that drives sideways has `~speed_lim_y`, and the accelerations of `v` to the side, too.

Commands have to arrive at a steady rate, as before a mux: commands that a network has delayed must not pass as new.
"""

import sys
from dataclasses import replace

from ur_nodes.motion.admission.probation import Probation, step_probation
from ur_nodes.motion.mux import start_mux
from ur_nodes.motion.mux_events import MuxSettings, Source, Velocity, VelocityCommand
from ur_nodes.motion.mux_runner import MuxRunner
from ur_nodes.motion.ramp import NO_AXIS, Axis
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import Twist
from ur_nodes.run import run

_TIMEOUT = 0.5  # s, as upstream at its longest
_SOURCE = Source("raw_cmd_vel", "~raw_cmd_vel", 0, _TIMEOUT, zeros_hold=True)
_NEVER = 1e9  # s: no limit on the time to stop


def start(node: Node) -> None:
    """Read the parameters and connect. Raises UserError."""
    if node.parameters.integer("robot_feedback", 0) != 0:
        node.log.warn("robot_feedback is not used here: ramps begin at the velocity that was last sent")
    settings = node.parameters.follow(_read_settings, lambda changed: runner.use(changed))
    runner = MuxRunner(node, start_mux(settings), "~smooth_cmd_vel")

    rhythm = Probation(_TIMEOUT)

    def on_twist(twist: Twist) -> None:
        nonlocal rhythm
        velocity = Velocity(twist.forward, twist.turn, twist.left)
        rhythm = step_probation(rhythm, node.steady(), motion=not velocity.still)
        if rhythm.accepted or velocity.still:
            runner.handle(VelocityCommand(0, velocity))

    node.subscribe(_SOURCE.topic, Twist, on_twist, Quality.EVERY)  # a cluster of commands has to be seen as one


def _read_settings(own: Parameters) -> MuxSettings:
    braking = own.number("decel_factor", 1.0, minimum=0.01)
    forward, turn = _read_axis(own, "v", "m/s", braking), _read_axis(own, "w", "rad/s", braking)
    aside = own.limit("speed_lim_y", 0.0, minimum=0.0, live="greatest velocity to either side, m/s")
    left = replace(forward, speed=aside) if aside else NO_AXIS
    period = 1.0 / own.number("frequency", 20.0, minimum=1.0, maximum=200.0)
    return MuxSettings(
        (_SOURCE,), forward, turn, period=period, brake_period=period, stop_time=_NEVER, lag=0.0, left=left
    )


def _read_axis(own: Parameters, letter: str, unit: str, braking: float) -> Axis:
    growth = own.number(f"accel_lim_{letter}", minimum=0.001)
    speed = own.limit(f"speed_lim_{letter}", minimum=0.001, live=f"greatest velocity, {unit}")
    return Axis(speed, growth, growth * braking)


def main() -> int:
    """Run until shutdown. Returns the exit code."""
    return run("velocity_smoother", start)


if __name__ == "__main__":
    sys.exit(main())
