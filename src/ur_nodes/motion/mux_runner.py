"""A running mux: events in, velocities out on `cmd_vel`, on time."""

import math
from collections.abc import Callable

from ur_nodes.motion.mux import MuxState, step
from ur_nodes.motion.mux_events import STILL, Event, MuxSettings, Velocity
from ur_nodes.motion.mux_time import mux_clock
from ur_nodes.motion.obstacle_stop.guard import Guard
from ur_nodes.motion.velocity_kind import KindWatch
from ur_nodes.ports.node import Node, Publisher, Timer
from ur_nodes.ports.values import StampedTwist, Twist

_FRAME = "base_link"


class BaseOutput:
    """Sends velocities on a topic, as Twist or TwistStamped. See KindWatch: while none is known, nothing is sent."""

    def __init__(self, node: Node, topic: str, on_subscriber: Callable[[], Velocity | None]) -> None:
        """`on_subscriber` returns, for each new subscriber, a value that all subscribers then get."""
        self._node, self._topic, self._on_subscriber = node, topic, on_subscriber
        self._publisher: Publisher[Twist | StampedTwist] | None = None
        self._value_of: Callable[[Velocity], Twist | StampedTwist] = _twist_of
        KindWatch(node, topic, node.subscribed_kinds, self._use, "velocities are sent as NAME, which the base takes")

    def send(self, velocity: Velocity) -> None:
        """Send a velocity."""
        if self._publisher is not None:
            self._publisher.send(self._value_of(velocity))

    def _use(self, kind: type[Twist | StampedTwist]) -> None:
        if self._publisher is not None:
            self._publisher.close()
        self._value_of = _twist_of if kind is Twist else lambda v: StampedTwist(self._node.now(), _FRAME, _twist_of(v))
        self._publisher = self._node.publish(self._topic, kind, on_subscriber=self._answer)

    def _answer(self) -> Twist | StampedTwist | None:
        velocity = self._on_subscriber()
        return None if velocity is None else self._value_of(velocity)


def _twist_of(velocity: Velocity) -> Twist:
    return Twist(velocity.forward, velocity.turn, velocity.left)


_END_ZEROS = 3


class MuxRunner:
    """Owns a state, steps it at events and when it is due, and publishes the outputs.

    `on_change` is called with every new state whose active source or emergency stop differs from the one before,
    `on_output` with every state that has sent something.
    """

    def __init__(
        self,
        node: Node,
        state: MuxState,
        topic: str,
        on_change: Callable[[MuxState], None] = lambda _: None,
        on_output: Callable[[MuxState], None] = lambda _: None,
    ) -> None:
        self._node, self._time = node, mux_clock(node)
        self._state = state
        self._on_change, self._on_output = on_change, on_output
        self._timer: Timer | None = None
        self._timer_at = state.next_at
        self._output = BaseOutput(node, topic, self._on_subscriber)
        node.on_end(self._end)
        on_change(state)

    def use(self, settings: MuxSettings) -> None:
        """Use changed limits from the next output on; the sources are the same."""
        self._state = self._state._replace(settings=settings)

    def guard(self, guard: Guard | None) -> None:
        """Have commands guarded from the next output on; None: they are not."""
        self._state = self._state._replace(guard=guard)
        if self._time() < self._state.now:
            self.handle(None)  # time was set back

    def handle(self, event: Event | None) -> MuxState:
        """Apply an event now (None: time has passed), and return the new state."""
        before = self._state
        self._state, output = step(before, event, self._time())
        if output is not None:
            self._output.send(output)
            self._on_output(self._state)
        if (before.active, before.stopped) != (self._state.active, self._state.stopped):
            self._on_change(self._state)
        if self._state.next_at != self._timer_at:
            self._arm()
        return self._state

    def _arm(self) -> None:
        """Schedule the next output."""
        if self._timer is not None:
            self._timer.cancel()
        self._timer, self._timer_at = None, self._state.next_at
        if self._timer_at < math.inf:
            left = self._timer_at - self._time()  # read again: sending took a moment
            self._timer = self._node.after(max(0.0, left), self._take_due)

    def _take_due(self) -> None:
        self._timer_at = math.nan  # the timer is used up
        self.handle(None)

    def _on_subscriber(self) -> Velocity | None:
        """Return a stop for each new subscriber: some drivers keep the last command of a mux that died."""
        return STILL if self._state.output.still else None

    def _end(self) -> None:
        if not self._state.output.still:
            for _ in range(_END_ZEROS):
                self._output.send(STILL)
