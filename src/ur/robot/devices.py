"""The devices that a base needs, and the devices that are connected to a computer."""

from ur.devices.known import DeviceSnapshot, Expected, Kind
from ur.devices.observe import device_script, parse_devices
from ur.robot.base.properties import Base
from ur.robot.ssh.shell import Shell

LOOK_SECONDS = 90.0


def expected_devices(base: Base) -> tuple[Expected, ...]:
    """Return the devices that the drivers of a base open: the base's own, then those of its sensors."""
    drivers = (*([base.driver] if base.driver else []), *base.drivers)
    found = []
    for driver in drivers:
        if driver.device.startswith("/"):  # and not behind TCP
            found.append(Expected(driver.part, _kind_of(driver.device), driver.device, driver.hardware, driver.baud))
        elif driver.part == "raspicam":
            found.append(Expected(driver.part, "camera"))
    return tuple(found)


def _kind_of(path: str) -> Kind:
    name = path.rpartition("/")[2]
    return "gpio" if name.startswith("gpiochip") else "i2c" if name.startswith("i2c-") else "serial"


def inspect_devices(shell: Shell) -> DeviceSnapshot:
    """Inspect the devices of a computer, as the user of the shell. Raises UserError if the connection breaks."""
    return parse_devices(shell.run(device_script(), timeout=LOOK_SECONDS).out)
