"""The battery."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from ur.robot.base.sensors.sensor import FrameOwners, Sensor, read_topic
from ur.source.section import Section

TECHNOLOGIES = ("lead-acid", "lifepo4", "lithium-ion", "lithium-polymer", "nicd", "nimh")


@dataclass(frozen=True, slots=True)
class BatteryProperties(Sensor):
    """The battery (sensor_msgs/BatteryState).

    `design_capacity` is in Ah; voltages are those without load. `current_idle` (A) flows while the base is at rest,
    `current_moving` at full speed.
    """

    title: ClassVar[str] = "battery"
    article: ClassVar[str] = "a"
    example: ClassVar[str] = """
battery: # Ah, V, A
  {topic: battery_state, technology: lithium-ion, design_capacity: 10.0, voltage_full: 16.6, voltage_empty: 12.8,
   current_idle: 0.8, current_moving: 2.5}
"""

    topic: str
    technology: str
    design_capacity: float
    voltage_full: float
    voltage_empty: float
    current_idle: float
    current_moving: float

    @classmethod
    def read(cls, part: Section, frames: FrameOwners) -> BatteryProperties:  # noqa: ARG003 - it has no frame
        """Read the section `battery`."""
        battery = cls(
            topic=read_topic(part, "battery_state"),
            technology=part.text("technology", choices=TECHNOLOGIES),
            design_capacity=part.number("design_capacity", minimum=0.01),
            voltage_full=part.number("voltage_full", minimum=0.1),
            voltage_empty=part.number("voltage_empty", minimum=0.1),
            current_idle=part.number("current_idle", minimum=0.0),
            current_moving=part.number("current_moving", minimum=0.0),
        )
        if battery.voltage_empty >= battery.voltage_full:
            text = f"voltage_empty: {battery.voltage_empty:g} in {part.name}, expected less than voltage_full"
            part.fail("voltage_empty", text)
        if battery.current_moving < battery.current_idle:
            text = f"current_moving: {battery.current_moving:g} in {part.name}, expected at least current_idle"
            part.fail("current_moving", text)
        return battery

    def topics(self) -> Mapping[str, str]:
        """The topic of the battery's state."""
        return {self.topic: "sensor_msgs/BatteryState"}

    def describe(self) -> str:
        """Topic, technology, capacity and voltages, as Markdown."""
        volts = f"{self.voltage_full:g} to {self.voltage_empty:g} V"
        return f"`{self.topic}`: {self.technology}, {self.design_capacity:g} Ah, {volts}"
