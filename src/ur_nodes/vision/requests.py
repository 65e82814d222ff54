"""Requests of clients to a `FiducialSlam`: set the pose, search for the robot, clear the map."""

from collections.abc import Callable

from ur_nodes.ports.node import Node
from ur_nodes.ports.services import Silent
from ur_nodes.ports.values import PoseEstimate, Result
from ur_nodes.vision.fiducial_parameters import SlamSettings
from ur_nodes.vision.fiducial_slam import FiducialSlam

MAP = "map"
"""The lane of all that uses the map."""


class FiducialMapRequests:
    """`initialpose` and `global_localization` on a map that is only read, `clear_map` on one that is built."""

    def __init__(self, node: Node, settings: SlamSettings, slam: FiducialSlam, forget: Callable[[], None]) -> None:
        """`forget` is called when the robot's place is no longer known."""
        self._node, self._settings, self._slam, self._on_forget = node, settings, slam, forget
        node.subscribe("initialpose", PoseEstimate, self._place)
        node.serve_later("clear_map", Silent, self._clear)
        if settings.read_only:
            node.serve_later("global_localization", Silent, self._forget)

    def _place(self, given: PoseEstimate) -> None:
        settings = self._settings
        if settings.read_only and given.frame == settings.map_frame:
            self._node.work(lambda: self._slam.set_pose(given.pose), lambda _done: None, MAP)
            return
        wanted = f"one in frame {settings.map_frame!r} while the map is only read (~read_only_map)"
        self._node.log.warn(f"initialpose in frame {given.frame!r} is of no use now, expected {wanted}")

    def _forget(self, _request: Silent, give: Callable[[Result], None]) -> None:
        def on_done(_done: None) -> None:
            self._on_forget()
            give(Result(True))

        self._node.work(self._slam.forget, on_done, MAP)

    def _clear(self, _request: Silent, give: Callable[[Result], None]) -> None:
        if self._settings.read_only:
            give(Result(False, "the map is only read (~read_only_map), expected a map that is being built"))
        else:
            self._node.work(self._slam.clear, lambda _done: give(Result(True)), MAP)
