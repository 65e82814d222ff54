"""Drivers and the stand-ins of their devices, made by their rows in `ur.robot.base.own_drivers`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from importlib import import_module
from typing import TYPE_CHECKING, TypeVar

from ur.robot.base import Base
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.robot.base.wiring import Wiring
from ur_nodes.drivers.boards.board import MotorBoard, RewiredBoard

if TYPE_CHECKING:
    from ur_nodes.drivers.imus.imu import InertialDevice
    from ur_nodes.drivers.lidars.lidar import LidarProtocol
    from ur_nodes.drivers.sonars.echoes import SonarPins
    from ur_nodes.simulator.devices.plant import Firmware, Plant

T = TypeVar("T")


def _make_all(sensor: str, suffix: str = "") -> dict[str, Callable[..., T]]:
    """Return constructors of one kind of driver. Each imports its module when it is called, and no other device's."""

    def make(entry_point: str, *arguments: object) -> T:  # type: ignore[type-var] # of the row
        module, _, name = entry_point.partition(":")
        made: T = getattr(import_module(f"ur_nodes.drivers.{module}"), name + suffix)(*arguments)
        return made

    return {name: partial(make, row.entry_point) for name, row in OWN_DRIVERS.items() if row.sensor == sensor}


BOARDS: Mapping[str, Callable[[Base], MotorBoard]] = _make_all("")
LIDARS: Mapping[str, Callable[[], LidarProtocol]] = _make_all("lidar")
IMUS: Mapping[str, Callable[[], InertialDevice]] = _make_all("imu")
SONARS: Mapping[str, Callable[[], tuple[SonarPins, ...]]] = _make_all("sonars")
FIRMWARES: Mapping[str, Callable[[Plant], Firmware]] = {**_make_all("", "Firmware"), **_make_all("lidar", "Firmware")}


def make_board(name: str, base: Base) -> MotorBoard:
    """Make a board by its name, with the wiring of the base."""
    board = BOARDS[name](base)
    wiring = base.driver.wiring if base.driver else Wiring()
    return RewiredBoard(board, wiring) if wiring.names else board
