"""The topics of one simulated robot's sensors, lidar and camera aside."""

from __future__ import annotations

from collections.abc import Collection

from ur_nodes.ports.node import Node
from ur_nodes.simulator.schedule import SimulationTick
from ur_nodes.simulator.settings import SimulatorSettings
from ur_nodes.simulator.simulation import Simulation


class SensorTopics:
    """Publishers for what the base has. Topics without subscribers cost nothing, latched ones aside."""

    def __init__(
        self,
        node: Node,
        simulation: Simulation,
        robot: int,
        prefix: str,
        settings: SimulatorSettings,
        *,
        without: Collection[str] = (),
    ) -> None:
        """`prefix` is put before topics and frames: '' for a single robot, else 'robot_<n>/'.

        `without` are the keys of sensors that others publish.
        """
        self._simulation, self._robot = simulation, robot
        every = simulation.senses[robot].each
        senses = {name: sense for name, sense in every.items() if name not in without}
        self._sends = {name: sense.advertise(node, prefix, settings.quality) for name, sense in senses.items()}
        self._constant = {name for name, sense in senses.items() if not sense.rate}

    def send(self, tick: SimulationTick, stamp: int) -> None:
        """Send the readings that are due."""
        for name, send in self._sends.items():
            if name in self._constant or name in tick.due:
                send(self._simulation.time, stamp)
