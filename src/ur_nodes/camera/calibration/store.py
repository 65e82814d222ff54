"""The client of the service by which a camera's node stores a calibration."""

from __future__ import annotations

import threading

from ur.source.diagnostic import UserError, error
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import UseCalibration
from ur_nodes.ports.values import Calibration, Result

_LIMIT = 5.0  # s
_POLL = 0.02  # s


class CalibrationClient:
    """Calls `CAMERA/set_camera_info`, for a user interface."""

    def __init__(self, node: Node, camera: str) -> None:
        self._node = node
        self._service = node.resolve(camera) + "/set_camera_info"
        self._result: Result | None = None

    def keep(self, calibration: Calibration, ended: threading.Event) -> str | None:
        """Let the camera's node use and store a calibration; return its answer, None if `ended` is set before.

        Not for the node's thread. Raises UserError.
        """
        request = UseCalibration(calibration)
        self._node.post(lambda: self._node.call(self._service, request, self._take, _LIMIT))
        while (result := self._result) is None:
            if ended.wait(_POLL):
                return None
        if not result.success:
            raise UserError(
                error(
                    f"the calibration is not stored: {self._service}: {result.text}",
                    rule="bad-calibration",
                    help="is the camera's node running? That of a simulated camera stores no calibration",
                )
            )
        return result.text

    def _take(self, result: Result) -> None:
        self._result = result
