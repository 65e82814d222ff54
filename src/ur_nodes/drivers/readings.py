"""Values that devices report, as protocol modules return them. SI units; nothing knows a time, a topic or a frame."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

NOT_MEASURED = float("nan")


@dataclass(frozen=True, slots=True)
class Counts:
    """The counters of the left and the right wheel, as the device has them: they wrap at `bits` bits."""

    left: int
    right: int
    bits: int = 32


@dataclass(frozen=True, slots=True)
class Power:
    """The battery: V, A (negative: discharging), Ah; NaN where it is not measured."""

    voltage: float
    current: float = NOT_MEASURED
    charge: float = NOT_MEASURED
    capacity: float = NOT_MEASURED
    charging: bool = False


@dataclass(frozen=True, slots=True)
class Contacts:
    """The states of all bumpers or of all cliff sensors of a device, by name."""

    kind: Literal["bumper", "cliff"]
    states: tuple[tuple[str, bool], ...]


@dataclass(frozen=True, slots=True)
class SonarEcho:
    """The distance (m) that a sonar of a board measured `age` s before the board reported it; `number`: from 0 on."""

    number: int
    distance: float
    age: float


@dataclass(frozen=True, slots=True)
class Motors:
    """The device's motors obey, or they do not, for a `reason` (a clause, as "the emergency stop is pressed")."""

    ready: bool
    reason: str = ""


@dataclass(frozen=True, slots=True)
class DeviceIdentity:
    """A device by its own account: model, firmware, number. `problem`: why it cannot be used; '' where it can."""

    text: str
    problem: str = ""


@dataclass(frozen=True, slots=True)
class Reply:
    """Bytes that the device is to get next, as the answer to what it has sent."""

    data: bytes


@dataclass(frozen=True, slots=True, eq=False)
class MeasuredBeams:
    """Measurements of a lidar in the order in which they were made, arrays (n,).

    `phases` (rad, 0 to 2 pi) grow from beam to beam: how far the head has turned from the device's own zero,
    `clockwise` as seen from above or not. `ranges` in m: +inf where nothing was measured, NaN where the device says
    that it failed (REP 117). `turn_time`: s a turn, as the device measures it; 0.0 where it does not. `behind`: how far
    (rad) the head has turned on since the last of them, when the device sent it. `sending`: s that their last frame
    took on the line. `frames`: how many brought them. `complete`: they are a whole turn, of a table that the device
    keeps and goes on filling; `turn_time` is known then.
    """

    phases: NDArray[np.float64]
    ranges: NDArray[np.float64]
    intensities: NDArray[np.float64]
    clockwise: bool = False
    turn_time: float = 0.0
    behind: float = 0.0
    sending: float = 0.0
    frames: int = 1
    complete: bool = False


Reading = Counts | Power | Contacts | SonarEcho | Motors | DeviceIdentity | MeasuredBeams | Reply
