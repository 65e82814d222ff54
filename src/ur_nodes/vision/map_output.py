"""The outputs of a map of fiducials: topics, and its file."""

from collections.abc import Callable, Mapping
from functools import partial

from ur.source.diagnostic import UserError
from ur_nodes.geometry.rigid import Floats, to_angles, to_pose
from ur_nodes.ports.fiducials import MappedFiducial, MappedFiducials
from ur_nodes.ports.node import Node
from ur_nodes.ports.qualities import Quality
from ur_nodes.ports.services import Trigger
from ur_nodes.ports.values import Marker, Markers, Result
from ur_nodes.vision.detect import Sizes
from ur_nodes.vision.fiducial_detect import MAP
from ur_nodes.vision.fiducial_map import MapEntry, write_map
from ur_nodes.vision.fiducial_parameters import SlamSettings
from ur_nodes.vision.fiducial_slam import FiducialSlam

_SHOW_EVERY = 1.0  # s between maps that are published
_SAVE_EVERY = 10.0  # s between maps that are written
_END_LIMIT = 10.0  # s: a large map takes long to refine


class FiducialMapOutput:
    """Publishes the map while it has subscribers, and saves it: when it has changed, on request, and at the end."""

    def __init__(self, node: Node, settings: SlamSettings, sizes: Sizes, slam: FiducialSlam) -> None:
        self._node, self._settings, self._sizes, self._slam = node, settings, sizes, slam
        self._markers = node.publish("fiducials", Markers, Quality.LATCHED)
        self._map = node.publish("fiducial_map", MappedFiducials, Quality.LATCHED)
        self._publish(slam.poses())
        node.serve_later("save_map", Trigger, self._answer)
        if not settings.read_only:
            node.every(_SHOW_EVERY, self._show)
            node.every(_SAVE_EVERY, self._save)
            node.on_end(self._save, within=_END_LIMIT)

    def _show(self) -> None:
        if self._markers.subscribers() or self._map.subscribers():
            self._node.work(self._slam.poses, self._publish, MAP)

    def _publish(self, poses: Mapping[int, Floats]) -> None:
        self._markers.send(make_markers(poses, self._sizes, self._settings.map_frame))
        self._map.send(make_map(poses))

    def _answer(self, _request: Trigger, give: Callable[[Result], None]) -> None:
        self._node.work(self._slam.entries, lambda entries: self._write(entries, give), MAP)

    def _save(self) -> None:
        self._node.work(self._slam.unsaved, lambda entries: self._write(entries, self._report), MAP)

    def _report(self, result: Result) -> None:
        if not result.success:
            self._node.log.error(result.text, every=60.0)

    def _write(self, entries: tuple[MapEntry, ...] | None, give: Callable[[Result], None]) -> None:
        if entries is not None:
            self._node.work(partial(self._write_file, entries), give, "file")

    def _write_file(self, entries: tuple[MapEntry, ...]) -> Result:
        path = self._settings.map_file
        try:
            write_map(path, entries)
        except UserError as problem:
            return Result(False, str(problem))
        return Result(True, f"{len(entries)} fiducials written to {path}")


def make_markers(poses: Mapping[int, Floats], sizes: Sizes, frame: str) -> Markers:
    """Make a plate with its number for each fiducial."""
    shown: list[Marker] = []
    for number, rigid in sorted(poses.items()):
        size, pose = sizes.of(number), to_pose(rigid)
        shown += [
            Marker("fiducials", number, "cube", pose, (size, size, 0.01), (0.95, 0.6, 0.1, 1.0)),
            Marker(
                *("numbers", number, "text", pose._replace(z=pose.z + size)),
                *((0.0, 0.0, 0.8 * size), (1.0, 1.0, 1.0, 1.0), str(number)),
            ),
        ]
    return Markers(0, frame, tuple(shown))


def make_map(poses: Mapping[int, Floats]) -> MappedFiducials:
    """Make the message with the poses of all fiducials, by number."""
    return MappedFiducials(
        tuple(
            MappedFiducial(number, (*pose[:3, 3].tolist(),), to_angles(pose)) for number, pose in sorted(poses.items())
        )
    )
