"""Inertial units on I2C: a module each, which knows its registers. `IMUS` has them by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur_nodes.drivers.imus.bno055 import Bno055
from ur_nodes.drivers.imus.imu import InertialDevice
from ur_nodes.drivers.imus.mpu6050 import Mpu6050

IMUS: Mapping[str, Callable[[], InertialDevice]] = {"bno055": Bno055, "mpu6050": Mpu6050}
