"""The driver of sonars on the pins of a Raspberry Pi, as a node: the board that the base file names."""

from __future__ import annotations

import sys
from functools import partial

from ur.source.diagnostic import UserError, error
from ur_nodes.drivers.health import report_to_file
from ur_nodes.drivers.registry import SONARS
from ur_nodes.drivers.settings import find_device, read_base
from ur_nodes.drivers.sonars.gpio_pins import open_gpio
from ur_nodes.drivers.sonars.sonar_driver import SonarDriver
from ur_nodes.ports.node import Node
from ur_nodes.run import run


def start(node: Node) -> None:
    """Read the parameters and open the pins. Raises UserError."""
    base = read_base(node.parameters)
    driver = next((each for each in base.drivers if each.part == "sonars"), None)
    kind = node.parameters.text("sonars", "") or (driver.protocol if driver else "")
    if kind not in SONARS:
        node.parameters.fail("sonars", kind, f"one of {', '.join(SONARS)}", SONARS)
    pins = SONARS[kind]()
    if base.sonars is None or len(base.sonars.at) != len(pins):
        there = len(base.sonars.at) if base.sonars else 0
        text = f"base {base.name!r} has {there} sonars, expected the {len(pins)} of {kind}"
        raise UserError(error(text, rule="no-sonars"))
    path = find_device(node.parameters, driver)
    SonarDriver(node, base.sonars, pins, (path, partial(open_gpio, path, pins)), report_to_file(node))


if __name__ == "__main__":
    sys.exit(run("sonar_driver", start))
