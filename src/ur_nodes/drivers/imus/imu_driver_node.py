"""The driver of an inertial unit, as a node: the kind that the base file names, on its I2C bus."""

from __future__ import annotations

import sys
from functools import partial

from ur.source.diagnostic import UserError, error
from ur_nodes.drivers.health import report_to_file
from ur_nodes.drivers.imus import IMUS
from ur_nodes.drivers.imus.i2c_bus import open_bus
from ur_nodes.drivers.imus.imu_driver import ImuDriver
from ur_nodes.drivers.settings import find_device, read_base
from ur_nodes.ports.node import Node
from ur_nodes.run import run


def start(node: Node) -> None:
    """Read the parameters and open the bus. Raises UserError."""
    base = read_base(node.parameters)
    if base.imu is None:
        raise UserError(error(f"base {base.name!r} has no imu, expected one with `sensors: imu`", rule="no-imu"))
    driver = next((each for each in base.drivers if each.part == "imu"), None)
    kind = node.parameters.text("imu", "") or (driver.protocol if driver else "")
    if kind not in IMUS:
        node.parameters.fail("imu", kind, f"one of {', '.join(IMUS)}", IMUS)
    path = find_device(node.parameters, driver)
    ImuDriver(node, base.imu, IMUS[kind](), (path, partial(open_bus, path)), report_to_file(node))


if __name__ == "__main__":
    sys.exit(run("imu_driver", start))
