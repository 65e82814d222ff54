"""Reports on the robot's lidar and wheels as its driving shows them: in the log, in `/diagnostics`, and in a file."""

import math
from contextlib import suppress
from functools import partial

from ur.devices.driver_health import MotionRecord, describe_errors, health_file, write_health
from ur_nodes.geometry.calibration import CalibrationFigures
from ur_nodes.ports.node import Node, Publisher
from ur_nodes.ports.raw import Fields

_PERIOD = 5.0  # s
HELP = "ur robot calibrate"


class CalibrationReports:
    """Reports the newest `figures` of a node that compares wheels and scans."""

    def __init__(self, node: Node) -> None:
        self.figures: CalibrationFigures | None = None
        self._node, self._reported = node, ""
        self._file = health_file(f"{node.name}.calibration")
        self._diagnostics: Publisher[Fields | bytes] | None = None
        with suppress(LookupError):
            self._diagnostics = node.raw.publish("/diagnostics", "diagnostic_msgs/DiagnosticArray")
        node.every(_PERIOD, self._beat, steady=True)
        node.on_end(lambda: self._file.unlink(missing_ok=True))

    def _beat(self) -> None:
        figures = self.figures
        if figures is None:
            return
        yaw, x, y, radius, separation = figures.clear
        record = MotionRecord(figures.metres, yaw, x, y, radius, separation)
        text = describe_errors(record)
        if text and not self._reported:
            self._node.log.warn(f"{text}; help: {HELP}")
        self._reported = text
        self._node.work(partial(write_health, self._file, record), lambda _: None, "calibration")
        if self._diagnostics is not None:
            status = {
                "level": int(bool(text)),
                "name": f"{self._node.name}: calibration",
                "message": f"{text}; {HELP}" if text else "lidar and wheels are as described",
                "values": [{"key": key, "value": value} for key, value in _describe_figures(figures)],
            }
            self._diagnostics.send({"status": [status]})


def _describe_figures(figures: CalibrationFigures) -> list[tuple[str, str]]:
    """Return all figures with their standard deviations, by names, for users."""
    found, spread = figures.errors, figures.deviations
    return [
        ("driven", f"{figures.metres:.0f} m"),
        ("lidar yaw", f"{math.degrees(found.yaw):.2f} +- {math.degrees(spread.yaw):.2f} degrees"),
        ("lidar x", f"{found.x:.3f} +- {spread.x:.3f} m"),
        ("lidar y", f"{found.y:.3f} +- {spread.y:.3f} m"),
        ("wheel radius", f"{100.0 * found.radius:+.2f} +- {100.0 * spread.radius:.2f} %"),
        ("wheel separation", f"{100.0 * found.separation:+.2f} +- {100.0 * spread.separation:.2f} %"),
    ]
