"""The health of a device, as its driver sees it: what is reported to `ur doctor`. It counts, and knows no file."""

from collections.abc import Callable
from functools import partial

from msgspec.structs import replace

from ur.devices.driver_health import DriverHealth, health_file, write_health
from ur_nodes.ports.node import Node

PERIOD = 5.0  # s
_LONGEST = 300  # characters of a text

Report = Callable[[DriverHealth], None]


class HealthMeter:
    """Collects what a driver knows about its device, and reports it every PERIOD."""

    def __init__(self, node: Node, device: str, kind: str, report: Report) -> None:
        self._node, self._report = node, report
        self._state = DriverHealth(device[:_LONGEST], kind[:_LONGEST])
        self._frames = self._damaged = 0
        self._reported = node.steady()
        node.every(PERIOD, self._beat, steady=True)

    def note(self, **changes: object) -> None:
        """Take what is known now, by the names of DriverHealth."""
        texts = {name: value[:_LONGEST] if isinstance(value, str) else value for name, value in changes.items()}
        if any(getattr(self._state, name) != value for name, value in texts.items()):
            was_open, self._state = self._state.open, replace(self._state, **texts)
            if self._state.open is not was_open:
                self._frames = self._damaged = 0

    def count(self, frames: int, damaged: int) -> None:
        """Take so many frames that were understood, and damaged ones."""
        self._frames += frames
        self._damaged += damaged

    def _beat(self) -> None:
        passed = self._node.steady() - self._reported
        self._reported += passed
        if passed > 0.0:
            rates = self._frames / passed, self._damaged / passed
            self._state = replace(self._state, frames=rates[0], damaged=rates[1])
        self._frames = self._damaged = 0
        self._report(self._state)


def report_to_file(node: Node, **facts: object) -> Report:
    """Make a report that writes the file of this node, which is removed at its end; `facts` are of DriverHealth."""
    path = health_file(node.name)
    node.on_end(lambda: path.unlink(missing_ok=True))

    def report(health: DriverHealth) -> None:
        node.work(partial(write_health, path, replace(health, **facts)), on_written, "health")

    def on_written(problem: str) -> None:
        if problem:
            node.log.warn(f"{path} cannot be written ({problem}); ur doctor does not see this driver", every=600.0)

    return report
