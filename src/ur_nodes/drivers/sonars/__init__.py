"""Sonars: HC-SR04 on the pins of a Raspberry Pi, and distances as messages. `SONARS` has the boards by name."""

from __future__ import annotations

from collections.abc import Mapping

from ur_nodes.drivers.sonars.echoes import SonarPins

SONARS: Mapping[str, tuple[SonarPins, ...]] = {
    # pi_sonar.cpp: the numbers of the BCM chip, trigger and echo, in the order of its frames `sonar_0` to `sonar_4`
    "magni_sonars": (
        SonarPins(20, 21),
        SonarPins(12, 16),
        SonarPins(23, 24),
        SonarPins(27, 22),
        SonarPins(19, 26),
    ),
}
