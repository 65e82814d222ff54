"""The registry of this project's drivers, by the names that base files use: `driver: create2`."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class OwnDriver:
    """A driver: `what` describes the hardware; the others are its device file, baud rate and known device.

    `entry_point` is the protocol below `ur_nodes.drivers`, as `lidars.xv11:Xv11`; the class beside it with `Firmware`
    at its end, `Xv11Firmware`, is the stand-in of the device. `sensor` is '' for the driver of a base; `baud` is 0
    where there is no serial line.
    `fastest` are the m/s and rad/s that every robot with this board can drive, where its makers say so. `watchdog` is
    the time (s) after the last command, at which the board of a base stops its motors by itself; 0.0: never.
    `clockwise` is whether a lidar turns clockwise as it measures, seen from above.
    """

    what: str
    entry_point: str
    sensor: str
    device: str
    baud: int = 0
    hardware: str = ""
    fastest: tuple[float, float] | None = None
    watchdog: float = 0.0
    clockwise: bool = False

    @property
    def drives_on(self) -> bool:
        """Return whether the board of a base has no watchdog, and so goes on with the last command that it got."""
        return not self.sensor and not self.watchdog

    @property
    def node(self) -> str:
        """The name of the launch directory that starts the driver."""
        return f"n_{self.executable}"

    @property
    def executable(self) -> str:
        """The name of the driver's executable in this package."""
        return _EXECUTABLES[self.sensor]


GUARD_SOCKET = "/run/motor-guard"
"""The socket of the unit that starts a guard of the motors for a driver."""

NO_WATCHDOG = "no watchdog: with driver and guard killed at once it drives on with its last command"
"""A warning about a board that `drives_on`."""

_EXECUTABLES = {"": "base_driver", "lidar": "lidar_driver", "sonars": "sonar_driver", "imu": "imu_driver"}
OWN_DRIVERS: Mapping[str, OwnDriver] = {
    "arduino": OwnDriver(
        "an Arduino with the sketch ur_base", "boards.arduino:Arduino", "", "/dev/ttyACM0", 115200, watchdog=0.15
    ),
    "create2": OwnDriver("an iRobot Create 2 or Roomba", "boards.create2:Create2", "", "/dev/create", 115200, "create"),
    "loki": OwnDriver("the board of a Loki", "boards.loki:Loki", "", "/dev/ttyAMA0", 115200, "pi-uart"),
    "magni": OwnDriver(
        "the motor board of a Magni", "boards.magni:Magni", "", "/dev/ttyAMA0", 38400, "pi-uart", watchdog=0.2
    ),
    "neato": OwnDriver(
        "a Neato Botvac or XV-11", "boards.neato:Neato", "", "/dev/neato", 115200, "neato", watchdog=0.35
    ),
    "turtlebot3": OwnDriver(
        "the OpenCR board of a TurtleBot3",
        "boards.opencr:OpenCr",
        "",
        "/dev/opencr",
        1000000,
        "opencr",
        (0.22, 1.82),
        watchdog=0.5,
    ),
    "rplidar": OwnDriver(
        "an RPLIDAR, standard scans",
        "lidars.rplidar:RplidarStandard",
        "lidar",
        "/dev/rplidar",
        115200,
        "rplidar",
        clockwise=True,
    ),
    "rplidar_express": OwnDriver(
        "an RPLIDAR, express scans",
        "lidars.rplidar:RplidarExpress",
        "lidar",
        "/dev/rplidar",
        115200,
        "rplidar",
        clockwise=True,
    ),
    "hokuyo": OwnDriver("a Hokuyo URG or UTM", "lidars.scip:Scip", "lidar", "/dev/hokuyo", 115200, "hokuyo"),
    "lds01": OwnDriver(
        "the LDS-01 of a TurtleBot3", "lidars.lds01:Lds01", "lidar", "/dev/lds", 230400, "lds-01", clockwise=True
    ),
    "lds02": OwnDriver(
        "the LDS-02 of a TurtleBot3", "lidars.ldrobot:Lds02", "lidar", "/dev/lds", 115200, "lds-01", clockwise=True
    ),
    "ld06": OwnDriver(
        "an LDROBOT LD06 or LD19", "lidars.ldrobot:LdRobot", "lidar", "/dev/ttyUSB0", 230400, clockwise=True
    ),
    "xv11": OwnDriver(
        "the lidar of a Neato XV-11, alone", "lidars.xv11:Xv11", "lidar", "/dev/xv11_lidar", 115200, "xv11-lidar"
    ),
    "ydlidar": OwnDriver(
        "a YDLIDAR X2 or X4", "lidars.ydlidar:Ydlidar", "lidar", "/dev/ydlidar", 128000, "ydlidar", clockwise=True
    ),
    "magni_sonars": OwnDriver("the board of sonars of a Magni", "sonars.echoes:magni_pins", "sonars", "/dev/gpiochip0"),
    "bno055": OwnDriver("a Bosch BNO055 on I2C", "imus.bno055:Bno055", "imu", "/dev/i2c-1"),
    "mpu6050": OwnDriver("an InvenSense MPU-6050 on I2C", "imus.mpu6050:Mpu6050", "imu", "/dev/i2c-1"),
}
