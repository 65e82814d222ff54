"""The node `joy_node`: reads a joystick, in place of upstream's.

Publishes `joy` on every change, and again at the autorepeat rate.
"""

import sys

from ur_nodes.motion.joystick.device import JoystickSettings
from ur_nodes.motion.joystick.joy_reader import FileDevice, JoyReader
from ur_nodes.ports.node import Node
from ur_nodes.run import run


def start(node: Node) -> None:
    """Read the parameters and connect. Raises UserError."""
    own = node.parameters
    rate = own.number("autorepeat_rate", 0.0, minimum=0.0, maximum=200.0)
    JoyReader(
        node,
        FileDevice(own.text("dev", "/dev/input/js0")),
        JoystickSettings(own.number("deadzone", 0.05, minimum=0.0, maximum=0.9), own.boolean("sticky_buttons", False)),
        1.0 / rate if rate else float("inf"),
        own.number("coalesce_interval", 0.001, minimum=0.0, maximum=0.1),
    )


def main() -> int:
    """Run until shutdown. Returns the exit code."""
    return run("joy_node", start)


if __name__ == "__main__":
    sys.exit(main())
