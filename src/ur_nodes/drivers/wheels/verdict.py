"""The test of wheels off the ground: its motions, and the wiring that counts and a person's answers show. Pure."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ur.robot.base.wiring import Wiring, find_wirings

DISTANCE = 0.10  # m that each wheel rolls
SPEED = 0.10  # m/s
_LEAST, _MOST = 0.07, 0.13  # m that a wheel may be counted to roll
_STILL = 0.02  # m, below which a wheel is not counted to turn
SIDES = ("left", "right")


@dataclass(frozen=True, slots=True)
class WheelMotion:
    """A motion: its name, and the directions of the left and the right wheel."""

    name: str
    signs: tuple[int, int]


MOTIONS = (
    WheelMotion("forward", (1, 1)),
    WheelMotion("back", (-1, -1)),
    WheelMotion("left", (-1, 1)),
    WheelMotion("right", (1, -1)),
)


@dataclass(frozen=True, slots=True)
class WheelObservation:
    """A motion as it went: the directions in which a person saw the wheels turn (0: not at all), and counts (m).

    `counted` are the distances of the board's left and right counter, without a wiring.
    """

    motion: WheelMotion
    seen: tuple[int, int]
    counted: tuple[float, float]

    @property
    def counted_signs(self) -> tuple[int, int]:
        """The directions in which the counters counted; 0: they did not."""
        left, right = (0 if abs(each) < _STILL else 1 if each > 0.0 else -1 for each in self.counted)
        return left, right


@dataclass(frozen=True, slots=True)
class WheelVerdict:
    """The result: the wiring that explains all observations, None where none does, and the problems."""

    wiring: Wiring | None
    problems: tuple[str, ...] = ()


def judge(observations: Sequence[WheelObservation]) -> WheelVerdict:
    """Compare what was asked for with what was seen and counted."""
    problems = tuple(dict.fromkeys(_list_problems(observations)))
    if problems:
        return WheelVerdict(None, problems)
    wirings = find_wirings(tuple((each.motion.signs, each.seen, each.counted_signs) for each in observations))
    if len(wirings) != 1:
        text = "the motions contradict each other: was each answer about the robot's own left and right?"
        return WheelVerdict(None, (text,))
    return WheelVerdict(wirings[0], tuple(dict.fromkeys(_list_distances(observations))))


def _list_problems(observations: Sequence[WheelObservation]) -> Iterator[str]:
    for each in observations:
        for side, seen in zip(SIDES, each.seen, strict=True):
            if not seen:
                yield f"the {side} wheel did not turn: check its motor, its fuse and the emergency stop"
        if 0 not in each.seen:
            for side, counted in zip(SIDES, each.counted_signs, strict=True):
                if not counted:
                    yield f"the board's {side} counter does not count: check that encoder and its cable"


def _list_distances(observations: Sequence[WheelObservation]) -> Iterator[str]:
    for each in observations:
        for side, metres in zip(SIDES, each.counted, strict=True):
            if not _LEAST <= abs(metres) <= _MOST:
                yield (
                    f"{each.motion.name}: the board's {side} counter shows {abs(metres):.2f} m for {DISTANCE:.2f} m:"
                    " check `ticks_per_turn` and the radius of the wheels in the base file"
                )
