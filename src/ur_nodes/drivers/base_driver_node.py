"""The driver of a real base, as a node: the board that the base file names, on its serial line."""

import sys

from ur.robot.base.own_drivers import OWN_DRIVERS
from ur.run.host.descendants import become_driver
from ur_nodes.drivers.base_driver import BaseDriver
from ur_nodes.drivers.health import report_to_file
from ur_nodes.drivers.registry import BOARDS, connect_serial, find_calibration, make_board, read_base
from ur_nodes.ports.node import Node
from ur_nodes.run import run


def start(node: Node) -> None:
    """Read the parameters and open the line. Raises UserError."""
    base = read_base(node.parameters)
    own = base.driver.protocol if base.driver else ""
    board = node.parameters.text("board", "") or own
    if board not in BOARDS:
        node.parameters.fail("board", board, f"one of {', '.join(BOARDS)}", BOARDS)
    orphaned = become_driver()
    used, stops = find_calibration(node.parameters).write(), base.limits.describe_stop()
    report = report_to_file(node, drives_on=OWN_DRIVERS[board].drives_on, stops=stops, calibration=used)
    BaseDriver(node, base, make_board(board, base), connect_serial(node, base.driver), report, orphaned)


if __name__ == "__main__":
    sys.exit(run("base_driver", start))
