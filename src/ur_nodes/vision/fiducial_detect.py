"""Answers to pictures with their fiducials, as on the topics of aruco_detect."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import cv2
import numpy as np

from ur_nodes.geometry.rigid import to_pose
from ur_nodes.pictures.decode import BadPictureError, Pixels, make_picture, unpack_picture
from ur_nodes.ports.fiducials import FiducialCorners, FiducialPose, SeenFiducials, StampedFiducials
from ur_nodes.ports.node import Node
from ur_nodes.ports.services import Silent
from ur_nodes.ports.values import PackedPicture, Picture, PoseEstimate, Result, Transform
from ur_nodes.vision.detect import CameraModel, Detection, Detector
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


def read_pixels(picture: Picture | PackedPicture, *, grey: bool = False) -> Pixels:
    """Rows from the top: red, green, blue (height, width, 3); with `grey` a packed picture is grey (height, width).

    Raises BadPictureError.
    """
    if isinstance(picture, Picture):
        return unpack_picture(picture.data, picture.width, picture.height, picture.step, picture.encoding)
    data = np.frombuffer(picture.data, np.uint8)
    try:
        found = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE if grey else cv2.IMREAD_COLOR) if data.size else None
    except cv2.error:  # more pixels than OpenCV allows
        found = None
    if found is None:
        raise BadPictureError(f"a compressed image of {data.size} bytes ({picture.format!r}), expected JPEG or PNG")
    return np.asarray(found if grey else cv2.cvtColor(found, cv2.COLOR_BGR2RGB), np.uint8)


def draw_fiducials(pixels: Pixels, found: Iterable[Detection], camera: CameraModel | None) -> Pixels:
    """A copy (height, width, 3) with the outlines of fiducials, and their axes where poses are known."""
    canvas = pixels.copy()
    listed = tuple(found)
    if listed:
        corners = [each.corners.astype(np.float32).reshape(1, 4, 2) for each in listed]
        cv2.aruco.drawDetectedMarkers(canvas, corners, np.array([[each.id] for each in listed], np.int32))
    for each in listed:
        if camera and each.candidates:
            pose = each.candidates[0].pose
            turn = cv2.Rodrigues(pose[:3, :3])[0]
            cv2.drawFrameAxes(canvas, camera.matrix, camera.distortion, turn, pose[:3, 3], each.size / 2.0)
    return np.asarray(canvas, np.uint8)


def pack_picture(pixels: Pixels, stamp: int, frame: str) -> PackedPicture:
    """Encode pixels (height, width, 3) as a JPEG picture."""
    data = cv2.imencode(".jpg", cv2.cvtColor(pixels, cv2.COLOR_RGB2BGR))[1].tobytes()
    return PackedPicture(stamp, frame, "jpeg", data)


@dataclass(frozen=True, slots=True)
class DetectionRequest:
    """A picture, its camera if poses are needed and it is calibrated, and the drawings that have subscribers."""

    picture: Picture | PackedPicture
    camera: CameraModel | None
    draw: bool = False
    pack: bool = False


@dataclass(frozen=True, slots=True)
class DetectionAnswer:
    """The fiducials of a picture; None without poses, or if the camera is not calibrated."""

    seen: SeenFiducials
    stamped: StampedFiducials | None = None
    drawn: Picture | None = None
    packed: PackedPicture | None = None

    def transforms(self) -> tuple[Transform, ...]:
        """Return the poses of the fiducials in the camera's frame."""
        placed = self.stamped
        if placed is None:
            return ()
        return tuple(
            Transform(placed.stamp, placed.frame, f"fiducial_{each.number}", each.pose) for each in placed.fiducials
        )


def answer_request(detector: Detector, request: DetectionRequest) -> DetectionAnswer | BadPictureError:
    """Find the fiducials of a picture, or the reason why it cannot be read."""
    picture, camera = request.picture, request.camera
    drawn = request.draw or request.pack
    try:
        pixels = read_pixels(picture, grey=not drawn)
    except BadPictureError as problem:
        return problem
    found = detector.detect(pixels, camera)
    head = picture.stamp, picture.frame
    seen = SeenFiducials(*head, picture.sequence, tuple(FiducialCorners(each.id, each.corners) for each in found))
    placed = None
    if camera:
        poses = tuple(_place(each) for each in found if each.candidates)
        placed = StampedFiducials(*head, picture.sequence, poses)
    if not drawn:
        return DetectionAnswer(seen, placed)
    canvas = draw_fiducials(pixels, found, camera)
    return DetectionAnswer(
        seen,
        placed,
        make_picture(canvas, *head) if request.draw else None,
        pack_picture(canvas, *head) if request.pack else None,
    )


def _place(found: Detection) -> FiducialPose:
    best = found.candidates[0]
    return FiducialPose(found.id, to_pose(best.pose), best.error, object_error(found), found.area)


def object_error(detection: Detection) -> float:
    """Return the error of the best pose in m, by the size of a pixel at the fiducial: its edge in m over pixels."""
    edge = float(np.sqrt(max(detection.area, 1e-9)))
    return detection.candidates[0].error * detection.size / edge
