"""Pictures in, fiducials out, as the topics of aruco_detect have them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ur_nodes.geometry.rigid import to_pose
from ur_nodes.pictures.decode import BadPictureError, make_picture
from ur_nodes.ports.fiducials import FiducialCorners, FiducialPose, PlacedFiducials, SeenFiducials
from ur_nodes.ports.values import PackedPicture, Picture, Transform
from ur_nodes.vision.detect import CameraModel, Detection, Detector
from ur_nodes.vision.pixels import draw_fiducials, pack_picture, read_pixels


@dataclass(frozen=True, slots=True)
class DetectionRequest:
    """A picture, the camera where poses are wanted and it is calibrated, and which drawings have subscribers."""

    picture: Picture | PackedPicture
    camera: CameraModel | None
    draw: bool = False
    pack: bool = False


@dataclass(frozen=True, slots=True)
class DetectionAnswer:
    """The fiducials of a picture; None: no pose was asked for, or the camera is not calibrated."""

    seen: SeenFiducials
    placed: PlacedFiducials | None = None
    drawn: Picture | None = None
    packed: PackedPicture | None = None

    def transforms(self) -> tuple[Transform, ...]:
        """The frames of the fiducials in that of the camera."""
        placed = self.placed
        if placed is None:
            return ()
        return tuple(
            Transform(placed.stamp, placed.frame, f"fiducial_{each.number}", each.pose) for each in placed.fiducials
        )


def answer_request(detector: Detector, request: DetectionRequest) -> DetectionAnswer | BadPictureError:
    """Find the fiducials of a picture, or the reason why it is none."""
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
        placed = PlacedFiducials(*head, picture.sequence, poses)
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
    """The error of the best pose in m at the fiducial: pixels there are as large as its edge is long for its size."""
    edge = float(np.sqrt(max(detection.area, 1e-9)))
    return detection.candidates[0].error * detection.size / edge
