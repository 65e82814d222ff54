"""Conversion of pictures to arrays and back, and drawings of detected fiducials."""

from __future__ import annotations

from collections.abc import Iterable

import cv2
import numpy as np

from ur_nodes.pictures.decode import BadPictureError, Pixels, unpack_picture
from ur_nodes.ports.values import PackedPicture, Picture
from ur_nodes.vision.detect import CameraModel, Detection


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
