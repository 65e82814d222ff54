"""The driver of a receiver of satellite navigation, as a node."""

from __future__ import annotations

import sys

from ur_nodes.drivers.gnss.gnss_driver import GnssDriver
from ur_nodes.drivers.gnss.ublox import Ublox
from ur_nodes.drivers.health import report_to_file
from ur_nodes.drivers.settings import connect_serial
from ur_nodes.ports.node import Node
from ur_nodes.run import run


def start(node: Node) -> None:
    """Read the parameters and open the line. Raises UserError."""
    frame = node.parameters.text("frame", "gps")
    GnssDriver(node, frame, Ublox(), connect_serial(node, None), report_to_file(node))


if __name__ == "__main__":
    sys.exit(run("gnss_driver", start))
