"""The mux of velocity commands: replaces twist_mux, with the emergency stop and the limits of the base."""

from __future__ import annotations

import sys

import rospy
from std_msgs.msg import Bool, Float32, String
from std_srvs.srv import Trigger, TriggerRequest, TriggerResponse

from ur.robot.base import Base, load_base
from ur.source.project import launch_library
from ur_nodes.motion.admission.admission_node import AdmissionRunner
from ur_nodes.motion.challenge.freshness import FRESHNESS
from ur_nodes.motion.mux import MuxState, start_mux
from ur_nodes.motion.mux_events import Event, LimitSpeed, MuxSettings, Release, Stop, Watch
from ur_nodes.motion.mux_runner_node import MuxRunner, make_clock
from ur_nodes.motion.obstacle_stop.obstacle_stop_node import ObstacleStop
from ur_nodes.motion.ramp import axes_of
from ur_nodes.motion.sources import read_locks, read_sources
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.shell import run_node

_SEEN = "~emergency_stop"  # on the parameter server, so that an emergency outlives this process
_LIMIT = "~speed_limit_percent"  # likewise
_LEAST = 5.0  # percent


class MuxNode:
    """Topics and services round a MuxRunner."""

    def __init__(self, settings: MuxSettings, base: Base, own: Parameters) -> None:
        self._settings = settings
        self._active = rospy.Publisher("~active", String, queue_size=1, latch=True)
        self._stopped = rospy.Publisher("~stopped", Bool, queue_size=1, latch=True)
        stopped = rospy.get_param(_SEEN, False) is True
        if stopped:
            rospy.logwarn("emergency stop is still on; call %s to end it", rospy.resolve_name("~release"))
        clock = make_clock()
        share = _read_share(rospy.get_param(_LIMIT, 100.0)) or 1.0
        self._limit = rospy.Publisher("~speed_limit_in_force", Float32, queue_size=1, latch=True)
        self._limit.publish(100.0 * share)
        state = start_mux(settings, stopped=stopped, share=share)
        self._obstacle_stop: ObstacleStop | None = None
        self._runner = MuxRunner(state, "cmd_vel_out", clock, self._publish_state, self._report_output)
        self._obstacle_stop = ObstacleStop(
            base,
            clock.read,
            lambda guard: self._runner.handle(Watch(guard)),
            on=own.boolean("obstacle_stop", False),
            sonars=own.boolean("use_sonars", True),
            lag=settings.lag,
        )
        self._admission = AdmissionRunner(
            settings,
            self._runner.handle,
            rate=own.number("challenge_rate", 50.0, minimum=20.0, maximum=100.0),
            freshness=own.number("freshness", FRESHNESS, minimum=0.05, maximum=0.5),
            lease_timeout=own.number("lease_timeout", 3.0, minimum=1.0, maximum=60.0),
            steady=clock.steady,
        )
        rospy.Subscriber("~speed_limit", Float32, self._on_limit, queue_size=1)
        rospy.Service("~stop", Trigger, self._on_stop)
        rospy.Service("~release", Trigger, self._on_release)

    def _on_stop(self, _request: TriggerRequest) -> TriggerResponse:
        return self._switch(Stop(), stopped=True)

    def _on_release(self, _request: TriggerRequest) -> TriggerResponse:
        return self._switch(Release(), stopped=False)

    def _switch(self, event: Event, *, stopped: bool) -> TriggerResponse:
        state = self._runner.handle(event)
        rospy.set_param(_SEEN, stopped)
        waiting = [
            source.name
            for source, received in zip(self._settings.sources, state.received, strict=True)
            if received.barred and not stopped
        ]
        hint = f"; {', '.join(waiting)} may drive after a pause" if waiting else ""
        return TriggerResponse(success=True, message="stopped" if stopped else f"released{hint}")

    def _on_limit(self, message: Float32) -> None:
        """Limit all sources to a percentage of the base's speeds, as Nav2 does with `speed_limit`; 0: no limit."""
        share = _read_share(message.data)
        if share is None:
            rospy.logwarn("speed limit of %g percent ignored, expected %g to 100, or 0 for none", message.data, _LEAST)
            return
        self._runner.handle(LimitSpeed(share))
        rospy.set_param(_LIMIT, 100.0 * share)
        self._limit.publish(100.0 * share)

    def _report_output(self, state: MuxState) -> None:
        if self._obstacle_stop is not None:
            wanted, output = state.wanted, state.output
            self._obstacle_stop.note(state.verdict, (wanted.forward, wanted.turn), (output.forward, output.turn))

    def _publish_state(self, state: MuxState) -> None:
        self._active.publish(state.active_name)
        self._stopped.publish(state.stopped)


def _read_share(percent: object) -> float | None:
    """The share of a percentage; None for what is none."""
    if not isinstance(percent, (int, float)) or isinstance(percent, bool):
        return None
    if percent == 0.0:
        return 1.0
    return float(percent) / 100.0 if _LEAST <= percent <= 100.0 else None


def start() -> None:
    """Read the parameters and run. Raises UserError."""
    own = Parameters()
    base = load_base(own.text("package", str(launch_library())), own.text("base"), own.text("variant", ""))
    forward, turn = axes_of(base.limits)
    MuxNode(
        MuxSettings(
            read_sources(rospy.get_param("~topics", None), rospy.resolve_name("~topics")),
            forward,
            turn,
            read_locks(rospy.get_param("~locks", []), rospy.resolve_name("~locks")),
            period=1.0 / own.number("rate", 50.0, minimum=10.0, maximum=100.0),
            stop_time=own.number("stop_time", 0.3, minimum=0.1, maximum=2.0),
            lag=own.number("lag", base.limits.lag, minimum=0.0, maximum=0.5),
        ),
        base,
        own,
    )


def main() -> int:
    """Run until shutdown. Returns the exit code."""
    return run_node("cmd_vel_mux", start)


if __name__ == "__main__":
    sys.exit(main())
