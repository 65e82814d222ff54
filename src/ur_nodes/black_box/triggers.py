"""Events after which the black box writes a file: changes on topics, as texts for users."""

from collections.abc import Callable
from dataclasses import dataclass, field

from ur_nodes.motion.lease.text import Lease, read_lease
from ur_nodes.ports.actions import GoalState
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality

_MOST_GOALS = 200
_LONGEST = 200  # characters of a text from another node
_IN_FORCE = 5_000_000_000  # ns after the subscription in which a first value may be one of before it


@dataclass(slots=True)
class Triggers:
    """Calls `happened` with a text for each event since the start; repetitions are left out.

    `clock` is in ns. The first message soon after a subscription describes an earlier state.
    """

    happened: Callable[[str], None]
    clock: Callable[[], int]
    _on: dict[str, bool] = field(default_factory=dict)
    _goals: dict[str, None] = field(default_factory=dict)
    _lost: str | None = None
    _driver: str = ""
    _since: dict[str, int] = field(default_factory=dict)

    def subscribe(self, node: Node, mux: str, navigation: str, localiser: str) -> None:
        """Subscribe to the topics of the mux, navigation and localisation, by the names of their nodes."""
        self._listen_to_switch(node, f"{mux}/stopped", "the emergency stop was pressed")
        node.subscribe(f"{mux}/lease", str, self.on_lease, _LATCHED)
        self._since[_LOST] = self.clock()
        node.subscribe(f"{localiser}/lost", str, self.on_lost, _LATCHED)
        node.follow_goals(navigation, self)

    def listen_to_bumper(self, node: Node, topic: str) -> None:
        """Subscribe to a bumper or cliff sensor."""
        name = topic.strip("/").replace("/", " ")
        self._listen_to_switch(node, topic, f"{name} was touched")

    def _listen_to_switch(self, node: Node, topic: str, text: str) -> None:
        self._since[text] = self.clock()
        node.subscribe(topic, bool, lambda on: self.switch(text, on), _LATCHED)

    def switch(self, text: str, on: bool) -> None:
        """Handle the state of a switch: switching on is an event."""
        before, self._on[text] = self._on.get(text, self._is_early(text)), on
        if on and not before:
            self.happened(text)

    def on_lost(self, text: str) -> None:
        """Handle the reason why localisation is lost; empty while it is not."""
        before = self._is_early(_LOST) if self._lost is None else bool(self._lost)
        self._lost = text
        if text and not before:
            self.happened(f"localisation is lost: {text[:_LONGEST]}")

    def _is_early(self, text: str) -> bool:
        return self.clock() - self._since.get(text, 0) < _IN_FORCE

    def on_states(self, states: tuple[GoalState, ...]) -> None:
        """Ignore the states; only ends are events."""

    def on_goal_end(self, state: GoalState) -> None:
        """Handle the end of a goal: one that was given up or refused is one event."""
        if state.state == "aborted" and state.id not in self._goals:
            self._goals[state.id] = None
            self.happened(f"a goal was aborted: {state.text[:_LONGEST]}")
            while len(self._goals) > _MOST_GOALS:
                del self._goals[next(iter(self._goals))]

    def on_lease(self, text: str) -> None:
        """Handle the lease: a new driver is an event, unless the robot was free before."""
        lease: Lease | None = read_lease(text)
        if lease is None or not lease.client:
            self._driver = ""
            return
        before, self._driver = self._driver, lease.client
        if before and before != lease.client:
            self.happened("another client has taken over")


_LOST = "lost"
_LATCHED = Quality.LATCHED
