"""Finds fiducials in the pictures of a camera: the node aruco_detect, with its topics, messages and parameters."""

from __future__ import annotations

import sys
from typing import Any

import cv2
import numpy as np
import rospy
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header

from ur.source.diagnostic import UserError
from ur_nodes.codecs.genpy.fiducials import message_classes
from ur_nodes.geometry.rigid import to_pose
from ur_nodes.rosio.ending import quiet_at_end
from ur_nodes.rosio.geometry import transform_message
from ur_nodes.rosio.parameters import Parameters
from ur_nodes.rosio.publishers import TransformSender
from ur_nodes.rosio.shell import run_node
from ur_nodes.vision.detect import DICTIONARIES, CameraModel, Detection, Detector
from ur_nodes.vision.fiducial_parameters import read_sizes
from ur_nodes.vision.image_message import (
    Pixels,
    make_compressed,
    make_image,
    read_camera,
    read_compressed,
    read_image,
)

_BUFFER = 1 << 24  # bytes: a picture that does not fit makes rospy fall behind


class FiducialDetect:
    """Publishes what each picture shows; pictures that arrive faster than they can be processed are left out."""

    def __init__(self, detector: Detector, own: Parameters) -> None:
        self._detector = detector
        self._camera: CameraModel | None = None
        self._warned = False
        self._estimate = own.boolean("do_pose_estimation", True)
        self._publish_tf = own.boolean("publish_fiducial_tf", True)
        self._draw = own.boolean("publish_images", True)
        raw = own.text("image_transport", "compressed", choices=("compressed", "raw")) == "raw"
        self._arrays = {name: message_classes(f"{name}Array") for name in ("Fiducial", "FiducialTransform")}
        self._vertices: Any = rospy.Publisher("fiducial_vertices", self._arrays["Fiducial"][0], queue_size=1)
        self._transforms: Any = rospy.Publisher(
            "fiducial_transforms", self._arrays["FiducialTransform"][0], queue_size=1
        )
        self._images: Any = rospy.Publisher("fiducial_images", Image, queue_size=1)
        self._jpegs: Any = rospy.Publisher("fiducial_images/compressed", CompressedImage, queue_size=1)
        self._tf = TransformSender(queue=10)
        rospy.Subscriber("camera_info", CameraInfo, self._take_info, queue_size=1)
        topic, kind = ("camera", Image) if raw else ("camera/compressed", CompressedImage)
        rospy.Subscriber(topic, kind, self._take, queue_size=1, buff_size=_BUFFER, tcp_nodelay=True)

    def _take_info(self, message: CameraInfo) -> None:
        self._camera = read_camera(message)
        if self._camera is None and not self._warned:
            self._warned = True
            rospy.logwarn("%s: the camera is not calibrated (K is 0): no poses", rospy.resolve_name("camera_info"))

    @quiet_at_end
    def _take(self, message: Any) -> None:
        drawn = self._draw and bool(self._images.get_num_connections() or self._jpegs.get_num_connections())
        try:
            pixels = read_image(message) if isinstance(message, Image) else read_compressed(message, grey=not drawn)
        except UserError as problem:
            rospy.logwarn_throttle(10.0, str(problem))
            return
        found = self._detector.detect(pixels, self._camera if self._estimate else None)
        header = Header(stamp=message.header.stamp, frame_id=message.header.frame_id)
        self._publish(found, header, message.header.seq)
        if drawn:
            self._publish_picture(pixels, found, header)

    def _publish(self, found: tuple[Detection, ...], header: Any, number: int) -> None:
        array, element = self._arrays["Fiducial"]
        vertices = [element(each.id, 0, *each.corners.ravel().tolist()) for each in found]
        self._vertices.publish(array(header, number, vertices))
        if not self._estimate or self._camera is None:
            return
        array, element = self._arrays["FiducialTransform"]
        placed = [(each, to_pose(each.candidates[0].pose)) for each in found if each.candidates]
        transforms = [
            element(each.id, transform_message(pose), each.candidates[0].error, object_error(each), each.area)
            for each, pose in placed
        ]
        self._transforms.publish(array(header, number, transforms))
        if self._publish_tf and placed:
            edges = [(header.frame_id, f"fiducial_{each.id}", pose) for each, pose in placed]
            self._tf.send(header.stamp, *edges)

    def _publish_picture(self, pixels: Pixels, found: tuple[Detection, ...], header: Any) -> None:
        canvas = cv2.cvtColor(pixels, cv2.COLOR_GRAY2RGB) if pixels.ndim == 2 else pixels.copy()
        if found:
            corners = [each.corners.astype(np.float32).reshape(1, 4, 2) for each in found]
            cv2.aruco.drawDetectedMarkers(canvas, corners, np.array([[each.id] for each in found], np.int32))
        for each in found if self._camera else ():
            if each.candidates and self._camera:
                pose = each.candidates[0].pose
                turn = cv2.Rodrigues(pose[:3, :3])[0]
                length = each.size / 2.0
                cv2.drawFrameAxes(canvas, self._camera.matrix, self._camera.distortion, turn, pose[:3, 3], length)
        drawn = np.asarray(canvas, np.uint8)
        if self._images.get_num_connections():
            self._images.publish(make_image(drawn, header))
        if self._jpegs.get_num_connections():
            self._jpegs.publish(make_compressed(drawn, header))


def object_error(detection: Detection) -> float:
    """The error of the best pose in m at the fiducial: pixels there are as large as its edge is long for its size."""
    edge = float(np.sqrt(max(detection.area, 1e-9)))
    return detection.candidates[0].error * detection.size / edge


def read_dictionary(own: Parameters) -> str:
    """`~dictionary`: a number of OpenCV's enumeration, as aruco_detect takes, or a name. Raises UserError."""
    value = rospy.get_param("~dictionary", 7)
    names = {getattr(cv2.aruco, f"DICT_{name}"): name for name in DICTIONARIES}
    if isinstance(value, int) and not isinstance(value, bool):
        if value not in names:
            own.fail("dictionary", value, f"a number from 0 to {max(names)} or a name such as 5X5_1000")
        return names[value]
    return own.text("dictionary", choices=DICTIONARIES)


def start() -> None:
    """Read the parameters and begin. Raises UserError."""
    own = Parameters()
    FiducialDetect(Detector(read_dictionary(own), read_sizes(own)), own)


def main() -> int:
    """Run the node. Returns the exit code."""
    return run_node("fiducial_detect", start)


if __name__ == "__main__":
    sys.exit(main())
