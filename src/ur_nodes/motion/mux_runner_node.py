"""A mux at work: events in from any thread, velocities out on `cmd_vel`, on time."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

import rospy
from geometry_msgs.msg import Twist, Vector3

from ur_nodes.motion.clock import Clock, read_steady_time
from ur_nodes.motion.mux import MuxState, step
from ur_nodes.motion.mux_events import STILL, Event, Velocity

_END_ZEROS = 3


def make_clock() -> Clock:
    """The clock of this node: real time, or the simulator's where that is the clock of all nodes."""
    if rospy.get_param("/use_sim_time", False) is True:
        return Clock(rospy.get_time, steady=False)
    return Clock(read_steady_time, steady=True)


class _SubscribeListener(rospy.SubscribeListener):  # type: ignore[misc]  # rospy has no types
    """Calls back for each new subscriber, with a publisher to it alone."""

    def __init__(self, on_subscribe: Callable[[Callable[[Twist], None]], None]) -> None:
        super().__init__()
        self._on_subscribe = on_subscribe

    def peer_subscribe(self, _topic: str, _publish: Callable[[Twist], None], peer: Callable[[Twist], None]) -> None:
        """See rospy."""
        self._on_subscribe(peer)


class MuxRunner:
    """Owns a state, steps it at events and when it is due, and publishes the outputs.

    `on_change` is called with every new state whose active source or emergency stop differs from the one before,
    `on_output` with every state that has sent something.
    """

    def __init__(
        self,
        state: MuxState,
        topic: str,
        clock: Clock,
        on_change: Callable[[MuxState], None],
        on_output: Callable[[MuxState], None] = lambda _: None,
    ) -> None:
        self._state = state
        self._on_output = on_output
        self._clock = clock
        self._on_change = on_change
        self._condition = threading.Condition()
        self._ended = False
        listener = _SubscribeListener(self._on_subscribe)
        self._publisher = rospy.Publisher(topic, Twist, queue_size=1, tcp_nodelay=True, subscriber_listener=listener)
        self._thread = threading.Thread(target=self._run, name="mux", daemon=True)
        rospy.on_shutdown(self._end)
        on_change(state)
        self._thread.start()

    def handle(self, event: Event | None) -> MuxState:
        """Let an event take effect now, and return the state after it."""
        with self._condition:
            if not self._ended:
                self._step(event)
                self._condition.notify()
            return self._state

    def _on_subscribe(self, publish: Callable[[Twist], None]) -> None:
        """Send a stop to each new subscriber: some drivers keep the last command of a mux that died."""
        with self._condition:
            if self._state.output.still:
                publish(twist_of(STILL))

    def _step(self, event: Event | None) -> None:
        before = self._state
        self._state, output = step(before, event, self._clock.read())
        if output is not None:
            self._publisher.publish(twist_of(output))
            self._on_output(self._state)
        if (before.active, before.stopped) != (self._state.active, self._state.stopped):
            self._on_change(self._state)

    def _run(self) -> None:
        with self._condition:
            while not self._ended:
                if self._clock.read() >= self._state.next_at:
                    self._step(None)
                self._clock.wait(self._condition, self._state.next_at)

    def _end(self) -> None:
        """Send a stop, and wait until it has left before the connections close."""
        with self._condition:
            self._ended = True
            self._condition.notify()
        if not self._state.output.still:
            for _ in range(_END_ZEROS):
                self._publisher.publish(twist_of(STILL))
                time.sleep(0.01)


def twist_of(velocity: Velocity) -> Twist:
    """The message."""
    return Twist(Vector3(velocity.forward, 0.0, 0.0), Vector3(0.0, 0.0, velocity.turn))
