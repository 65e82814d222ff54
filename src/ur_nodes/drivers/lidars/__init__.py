"""Lidars: a module each, bytes in, values out; no I/O and no clock. `LIDARS` has them by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ur_nodes.drivers.lidars.ldrobot import LdRobot, Lds02
from ur_nodes.drivers.lidars.lds01 import Lds01
from ur_nodes.drivers.lidars.lidar import LidarProtocol
from ur_nodes.drivers.lidars.rplidar import RplidarExpress, RplidarStandard
from ur_nodes.drivers.lidars.scip import Scip
from ur_nodes.drivers.lidars.xv11 import Xv11
from ur_nodes.drivers.lidars.ydlidar import Ydlidar

LIDARS: Mapping[str, Callable[[], LidarProtocol]] = {
    "rplidar": RplidarStandard,
    "rplidar_express": RplidarExpress,
    "ld06": LdRobot,
    "lds01": Lds01,
    "lds02": Lds02,
    "hokuyo": Scip,
    "xv11": Xv11,
    "ydlidar": Ydlidar,
}
