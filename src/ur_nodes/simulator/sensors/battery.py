"""A battery whose charge is counted."""

from __future__ import annotations

from ur.robot.base import BatteryProperties

SECONDS_PER_HOUR = 3600.0


class BatteryCharge:
    """The charge of a battery. Its voltage falls in a straight line from full to empty; it does not fall under load."""

    def __init__(self, battery: BatteryProperties, fraction: float = 1.0) -> None:
        """`fraction` of its capacity is in it at first."""
        self._battery = battery
        self._charge = battery.design_capacity * min(1.0, max(0.0, fraction))
        self._current = 0.0

    @property
    def charge(self) -> float:
        """The remaining charge, Ah."""
        return self._charge

    @property
    def fraction(self) -> float:
        """The remaining charge as a share, 0 to 1."""
        return self._charge / self._battery.design_capacity

    @property
    def voltage(self) -> float:
        """V."""
        empty, full = self._battery.voltage_empty, self._battery.voltage_full
        return empty + self.fraction * (full - empty)

    @property
    def current(self) -> float:
        """The recent current into the battery, A: negative, for it is drawn from it."""
        return -self._current

    def draw(self, effort: float, seconds: float) -> None:
        """Some time in which the base moved at the share `effort` (0 to 1) of its full speed, on average."""
        idle = self._battery.current_idle
        self._current = idle + effort * (self._battery.current_moving - idle)
        self._charge = max(0.0, self._charge - self._current * seconds / SECONDS_PER_HOUR)
