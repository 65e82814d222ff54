"""Lanes: a base with a mux and one commander each, side by side in namespaces, so that one cut is a trial of all."""

from dataclasses import dataclass
from typing import Literal, TypeVar

Axis = Literal["linear", "angular"]
Number = TypeVar("Number", int, float)
GOALS = "goals"
COMMANDERS = ("keyboard", "joystick", "plain", "rostopic", GOALS)
LEASED = ("keyboard", "joystick")  # these take part in the lease of the robot
TOPICS = {
    "keyboard": "key_vel",
    "joystick": "joy_vel",
    "plain": "key_vel",
    "rostopic": "key_vel",
    "phone": "key_vel",
    GOALS: "nav_vel",
}
_LIMITS = {GOALS: 3.0}  # s: a robot that has lost who attends its goal is stopped after 2.5 s, and brakes


@dataclass(frozen=True, slots=True)
class Lane:
    """A commander of a kind, the axis along which it drives, and how fast: m/s or rad/s.

    Lanes with the same `namespace` share a mux.
    """

    commander: str
    axis: Axis
    speed: float
    namespace: str = ""
    rest: float = 0.3  # s: the longest time that the robot may move after the last fresh command

    @property
    def name(self) -> str:
        """Its namespace; one of its own unless given."""
        return self.namespace or f"{self.commander}_{self.axis}"

    @property
    def prefix(self) -> str:
        """In front of the names of its topics: empty where a whole robot runs, which knows no namespace."""
        return "" if self.commander == GOALS else f"/{self.name}"

    @property
    def limit(self) -> float:
        """The longest time that the robot may move after the last fresh command: s."""
        return _LIMITS.get(self.commander, self.rest)

    @property
    def topic(self) -> str:
        """The topic of the commander's velocities in the namespace."""
        return TOPICS[self.commander]

    def pick(self, forward: Number, turn: Number) -> tuple[Number, Number]:
        """The velocity along its axis, and the one along the other; and back."""
        return (forward, turn) if self.axis == "linear" else (turn, forward)


@dataclass(frozen=True, slots=True)
class Pattern:
    """The person's commands: signs in a row, each with its duration (s), again and again. 0: keys released."""

    steps: tuple[tuple[float, int], ...]

    def sign_at(self, seconds: float) -> int:
        """The sign so many seconds after the start."""
        left = seconds % sum(duration for duration, _ in self.steps)
        for duration, sign in self.steps:
            if left < duration:
                return sign
            left -= duration
        return self.steps[-1][1]


HELD = Pattern(((1.0, 1),))
HELD_BACK = Pattern(((1.0, -1),))
ALTERNATING = Pattern(((0.9, 1), (0.7, 0), (0.9, -1), (0.7, 0)))
PATTERNS = {"held": HELD, "held back": HELD_BACK, "alternating": ALTERNATING}
