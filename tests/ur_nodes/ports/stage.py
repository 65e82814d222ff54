"""The stage of the contract: two nodes, a way to let time pass, and those who take, send and follow goals."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple, Protocol

from ur_nodes.geometry.pose import Pose2
from ur_nodes.ports.actions import Goal, GoalHandle, GoalId, GoalState
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.values import StampedPose

STAMP = 1_700_000_000_123_456_789
TARGET = StampedPose(STAMP, "map", Pose2(1.0, 2.0, 0.5))


class Described(NamedTuple):
    """A parameter, as another program sees it."""

    text: str
    minimum: float
    maximum: float
    read_only: bool


class Stage(Protocol):
    """Two nodes (one and the same, where a process has only one), and time. `begin` lets their callbacks come."""

    one: Node
    other: Node
    raw_senders_unknown: bool
    """The backend does not tell who has sent a raw message."""
    moments_known: bool
    """The middleware tells publishers of a node apart, and when each message was sent."""
    silent_services_hide_failures: bool
    """The answer of a service without a result is the same where it failed."""
    keeps_for_all: bool
    """What a LATCHED topic has kept is given to all subscribers, and a LATCHED subscriber hears all publishers."""
    only_live_parameters: bool
    """Other programs see no parameters that are read at the start."""
    string_type: str
    """The middleware's name of the type of a text."""
    wire: bytes
    """The text 'hello' as it travels."""

    def begin(self) -> None:
        """Start."""

    def until(self, condition: Callable[[], bool]) -> None:
        """Let time pass until a condition is true; fails after a while."""

    def spoil(self, topic: str) -> None:
        """Send a map that cannot be read, after `begin`, on a topic that has a subscriber."""

    def set_parameter(self, name: str, value: object) -> str:
        """Set a parameter of `one` from another program, after `begin`; '' or the reason of a refusal."""

    def describe(self, name: str) -> Described:
        """Describe a parameter of `one` for another program, after `begin`."""

    def client(self, action: str) -> GoalClient:
        """A client of goals that is connected, after `begin`."""


class GoalClient(Protocol):
    """The other end of `serve_goals`, as clients of the backend have it."""

    def send(self, target: StampedPose) -> str:
        """Send a goal; returns its id."""

    def cancel(self, id: str) -> None:
        """Cancel it; '' for all."""

    def cancel_sent_before(self, id: str) -> None:
        """Cancel all goals that were sent before this one, and it."""

    def state(self, id: str) -> tuple[str, str]:
        """The state and its text, as last heard: `ports.actions.GoalState`."""

    def report(self) -> StampedPose | None:
        """The last pose that was heard."""


class Follower:
    """A node that sends goals: the ids of those that are open, and the ends that it heard of."""

    def __init__(self) -> None:
        self.open: set[str] = set()
        self.ends: list[GoalState] = []

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        self.open = {each.id for each in states if each.open}

    def on_goal_end(self, state: GoalState) -> None:
        self.ends.append(state)


class Takers:
    """A node that takes goals, and what it got."""

    def __init__(self) -> None:
        self.got: list[GoalHandle] = []
        self.cancelled: list[str] = []

    def handle_goal(self, handle: GoalHandle) -> None:
        self.got.append(handle)

    def handle_cancel(self, handle: GoalHandle) -> None:
        self.cancelled.append(handle.goal.id)
        handle.cancel("as you wish")

    def has_cancelled(self, count: int) -> bool:
        return len(self.cancelled) == count


class TopicGoalClient:
    """See GoalClient. `wait` lets some of the backend's time pass."""

    def __init__(self, node: Node, action: str, wait: Callable[[], None]) -> None:
        self._node, self._wait = node, wait
        self._goals = node.publish(f"{action}/goal", Goal, Quality.EVERY)
        self._cancels = node.publish(f"{action}/cancel", GoalId, Quality.EVERY)
        self._between: list[int] = []  # ns: before each goal, when those before it have arrived
        self._states: dict[str, GoalState] = {}
        self._heard: StampedPose | None = None
        node.subscribe(
            f"{action}/state", GoalState, lambda state: self._states.update({state.id: state}), Quality.EVERY
        )
        node.subscribe(f"{action}/feedback", StampedPose, self._take_feedback)

    def is_connected(self) -> bool:
        return min(self._goals.subscribers(), self._cancels.subscribers()) > 0

    def send(self, target: StampedPose) -> str:
        self._between.append(self._node.now())
        self._wait()
        self._goals.send(Goal(str(len(self._between)), target))
        return str(len(self._between))

    def cancel(self, id: str) -> None:
        self._cancels.send(GoalId(id))

    def cancel_sent_before(self, id: str) -> None:
        self._cancels.send(GoalId(stamp=self._between[int(id)]))

    def state(self, id: str) -> tuple[str, str]:
        state = self._states.get(id, GoalState(id, "pending", ""))
        return state.state, state.text

    def report(self) -> StampedPose | None:
        return self._heard

    def _take_feedback(self, pose: StampedPose) -> None:
        self._heard = pose
