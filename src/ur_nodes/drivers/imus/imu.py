"""The shape of a driver of an inertial unit on I2C: a class that sets it up, and turns its registers into readings."""

from dataclasses import dataclass
from typing import Protocol

from ur_nodes.geometry.pose import Quaternion

Triple = tuple[float, float, float]


class I2cBus(Protocol):
    """An I2C bus. Both methods raise OSError where the device does not answer."""

    def read(self, address: int, register: int, count: int) -> bytes:
        """Read registers, at most 32."""

    def write(self, address: int, register: int, value: int) -> None:
        """Write a register."""

    def close(self) -> None:
        """Close the bus."""


@dataclass(frozen=True, slots=True)
class InertialReading:
    """A reading: turning (rad/s), force (m/s^2), and the orientation (x, y, z, w) where the unit computes it."""

    turning: Triple
    force: Triple
    orientation: Quaternion | None = None


@dataclass(frozen=True, slots=True)
class UnitIdentity:
    """A unit by its own account; `problem`: why it cannot be used."""

    text: str
    problem: str = ""


class InertialDevice(Protocol):
    """The registers of one kind of inertial unit. Its methods raise OSError, as the bus."""

    name: str
    """For messages, as "BNO055"."""

    def begin(self, bus: I2cBus) -> UnitIdentity:
        """Set it up; it takes a second at most."""

    def read(self, bus: I2cBus) -> InertialReading | None:
        """Return a reading; None while the unit warms up, or if the values are out of range."""
