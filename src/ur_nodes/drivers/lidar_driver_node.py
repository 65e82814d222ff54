"""The driver of a lidar, as a node: the kind that the base file names, on its serial line."""

import sys

from ur.source.diagnostic import user_error
from ur_nodes.drivers.health import report_to_file
from ur_nodes.drivers.lidar_driver import LidarDriver
from ur_nodes.drivers.registry import LIDARS, connect_serial, find_calibration, read_base
from ur_nodes.ports.node import Node
from ur_nodes.run import run


def start(node: Node) -> None:
    """Read the parameters and open the line. Raises UserError."""
    base = read_base(node.parameters)
    if base.lidar is None:
        raise user_error(f"base {base.name!r} has no lidar, expected one with `sensors: lidar`", rule="no-lidar")
    driver = next((each for each in base.drivers if each.part == "lidar"), None)
    kind = node.parameters.text("lidar", "") or (driver.protocol if driver else "")
    if kind not in LIDARS:
        node.parameters.fail("lidar", kind, f"one of {', '.join(LIDARS)}", LIDARS)
    offset = node.parameters.number("offset", 0.0)
    report = report_to_file(node, calibration=find_calibration(node.parameters).write())
    LidarDriver(node, base.lidar, LIDARS[kind](), connect_serial(node, driver), offset, report)


if __name__ == "__main__":
    sys.exit(run("lidar_driver", start))
