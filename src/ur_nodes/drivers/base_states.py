"""States of a real base that its driver does not report: bumpers that are released, and angles of the wheels."""

import math
from collections.abc import Iterable

from ur.robot.base import Wheels

WHEEL_JOINTS = ("left_wheel_joint", "right_wheel_joint")
HOLD = 0.5  # s; a driver that reads its bumpers five times a second may take that long to report one again
PLAUSIBLE = 50.0  # m/s and rad/s; no base that is driven here moves like that
LONGEST_GAP = 0.5  # s without odometry, after which it is not known how far the wheels turned


class BumperStates:
    """The bumpers of a base, by name, from a driver that reports only the pressed ones."""

    def __init__(self, names: Iterable[str]) -> None:
        self._pressed = dict.fromkeys(names, -math.inf)
        self._reported: dict[str, bool] = {}

    def press(self, name: str, time: float) -> None:
        """Note that a bumper is pressed at a time (s). Names that the base does not have are ignored."""
        if name in self._pressed:
            self._pressed[name] = time

    def changes(self, time: float) -> dict[str, bool]:
        """Return the states at a time (s) that differ from those of the last call; all of them at the first call."""
        now = {name: 0.0 <= time - pressed <= HOLD for name, pressed in self._pressed.items()}
        changed = {name: state for name, state in now.items() if self._reported.get(name) is not state}
        self._reported = now
        return changed


class WheelStates:
    """Angles (rad) and speeds (rad/s) of the left and the right wheel; forward is positive, angles begin at 0."""

    def __init__(self, wheels: Wheels) -> None:
        self._wheels = wheels
        self._time: float | None = None
        self.angles = (0.0, 0.0)
        self.speeds = (0.0, 0.0)

    def update(self, forward: float, turn: float, time: float) -> bool:
        """The base moves at m/s and rad/s at a time (s). Differential drive: v +- w b / 2 at the rims.

        Returns False, and changes nothing, for speeds beyond PLAUSIBLE or no numbers: the driver misread its line.
        """
        if not (abs(forward) <= PLAUSIBLE and abs(turn) <= PLAUSIBLE):
            return False
        across = turn * self._wheels.separation / 2.0
        speeds = ((forward - across) / self._wheels.radius, (forward + across) / self._wheels.radius)
        gap = time - self._time if self._time is not None else 0.0
        if 0.0 < gap <= LONGEST_GAP:
            left, right = (
                angle + (before + now) / 2.0 * gap
                for angle, before, now in zip(self.angles, self.speeds, speeds, strict=True)
            )
            self.angles = (left, right)
        self.speeds, self._time = speeds, time
        return True
