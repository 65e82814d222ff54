"""Settings of the simulator node."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Frames:
    """Names of frames, without a robot's prefix."""

    map: str
    odom: str
    base: str


@dataclass(frozen=True, slots=True)
class Settings:
    """`speed` is simulated seconds per second, 0 as fast as possible; `step_period` what one ~step advances by, s."""

    speed: float
    publish_clock: bool
    clock_rate: float
    joint_rate: float
    step_period: float
    frames: Frames

    @property
    def queue_size(self) -> int | None:
        """Return the number of unsent messages that a topic keeps.

        At full speed none: there the simulation waits for its listeners, and nothing is lost.
        """
        return None if self.speed == 0.0 else 100
