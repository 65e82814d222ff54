"""Drivers and the stand-ins of their devices, by their rows in `ur.robot.base.own_drivers`, and their parameters."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from ur.robot.base import Base, UpstreamDriver, load_base
from ur.robot.base.calibration import Calibration
from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.robot.base.properties import Wiring
from ur.robot.robot_file import RobotFile, load_robot_file
from ur.source.project import launch_library
from ur_nodes.drivers.boards.board import MotorBoard, RewiredBoard
from ur_nodes.drivers.lines.line import Connect, DeviceLine, LineSettings, LineUser
from ur_nodes.drivers.lines.serial_line import SCHEME, SerialLine
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters

if TYPE_CHECKING:
    from ur_nodes.drivers.imus.imu import InertialDevice
    from ur_nodes.drivers.lidars.lidar import LidarProtocol
    from ur_nodes.drivers.sonars.echoes import SonarPins
    from ur_nodes.simulator.devices.plant import Firmware, Plant


def read_base(own: Parameters) -> Base:
    """The base that parameters name, as its robot is calibrated; simulated devices are not. Raises UserError."""
    base = load_base(own.text("package", str(launch_library())), own.text("base"), own.text("variant", ""))
    return find_calibration(own).apply(base)


def find_calibration(own: Parameters, load: Callable[[], RobotFile | None] = load_robot_file) -> Calibration:
    """The calibration of the robot with the base that parameters name. Raises UserError."""
    robot = load() if own.text("device_folder", "/dev") == "/dev" else None
    own_base = robot is not None and robot.base == own.text("base")
    return (own_base and robot and robot.calibration) or Calibration()


def find_device(own: Parameters, driver: UpstreamDriver | None) -> str:
    """The device of `~device`, or of the base file, in the folder of `~device_folder`. Raises UserError."""
    path = own.text("device", "") or (driver.device if driver else "")
    if not path.startswith(("/", SCHEME)):
        own.fail("device", path, f"a device file, as /dev/create, or {SCHEME}HOST:PORT")
    folder = own.text("device_folder", "/dev")
    return path if folder == "/dev" else str(Path(folder, Path(path).name))


def connect_serial(node: Node, driver: UpstreamDriver | None) -> Connect:
    """Make lines to the device of `~device`, or of the base file, at the speed of `~baud`. Raises UserError."""
    own = node.parameters
    path = find_device(own, driver)
    baud = own.integer("baud", 0, minimum=0) or (driver.baud if driver else 0)

    def connect(user: LineUser, settings: LineSettings) -> DeviceLine:
        known = replace(settings, baud=baud or settings.baud)
        return SerialLine(node, path, user, known)

    return connect


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
