"""Parameters of the driver nodes."""

from dataclasses import replace
from pathlib import Path

from ur.robot.base import Base, UpstreamDriver, load_base
from ur.source.project import launch_library
from ur_nodes.drivers.lines.line import Connect, DeviceLine, LineSettings, LineUser
from ur_nodes.drivers.lines.serial_line import SerialLine
from ur_nodes.drivers.lines.tcp import SCHEME
from ur_nodes.ports.node import Node
from ur_nodes.ports.parameters import Parameters


def read_base(own: Parameters) -> Base:
    """The base that parameters name. Raises UserError."""
    return load_base(own.text("package", str(launch_library())), own.text("base"), own.text("variant", ""))


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
