"""Finds fiducials in the pictures of a camera: the node aruco_detect, with its topics, messages and parameters."""

import sys
from functools import partial

from ur_nodes.pictures.decode import BadPictureError
from ur_nodes.ports.fiducials import SeenFiducials, StampedFiducials
from ur_nodes.ports.newest_work import NewestWork
from ur_nodes.ports.node import Node
from ur_nodes.ports.values import Calibration, PackedPicture, Picture
from ur_nodes.run import run
from ur_nodes.vision.detect import CameraModel, Detector, camera_model
from ur_nodes.vision.fiducial_detect import DetectionAnswer, DetectionRequest, answer_request
from ur_nodes.vision.fiducial_parameters import read_detect_settings


class FiducialDetect:
    """Publishes what each picture shows; pictures that arrive faster than they can be processed are left out."""

    def __init__(self, node: Node) -> None:
        self._node = node
        self._settings = settings = read_detect_settings(node.parameters)
        self._camera: CameraModel | None = None
        self._warned = False
        self._vertices = node.publish("fiducial_vertices", SeenFiducials)
        self._placed = node.publish("fiducial_transforms", StampedFiducials)
        self._images = node.publish("fiducial_images", Picture)
        self._jpegs = node.publish("fiducial_images/compressed", PackedPicture)
        detector = Detector(settings.dictionary, settings.sizes)
        self._work = NewestWork(node, "pictures", partial(answer_request, detector), self._send)
        node.subscribe("camera_info", Calibration, self._on_calibration)
        if settings.raw:
            node.subscribe("camera", Picture, self._on_picture)
        else:
            node.subscribe("camera/compressed", PackedPicture, self._on_picture)

    def _on_calibration(self, calibration: Calibration) -> None:
        self._camera = camera_model(calibration)
        if self._camera is None and not self._warned:
            self._warned = True
            topic = self._node.resolve("camera_info")
            self._node.log.warn(f"{topic}: the camera is not calibrated (K is 0): no poses")

    def _on_picture(self, picture: Picture | PackedPicture) -> None:
        draw = self._settings.draw
        self._work.ask(
            DetectionRequest(
                picture,
                self._camera if self._settings.estimate else None,
                draw and bool(self._images.subscribers()),
                draw and bool(self._jpegs.subscribers()),
            )
        )

    def _send(self, _request: DetectionRequest, answer: DetectionAnswer | BadPictureError) -> None:
        if isinstance(answer, BadPictureError):
            self._node.log.warn(str(answer), every=10.0)
            return
        self._vertices.send(answer.seen)
        if answer.stamped:
            self._placed.send(answer.stamped)
        if self._settings.publish_tf and (transforms := answer.transforms()):
            self._node.transforms.send(*transforms)
        if answer.drawn:
            self._images.send(answer.drawn)
        if answer.packed:
            self._jpegs.send(answer.packed)


if __name__ == "__main__":
    sys.exit(run("fiducial_detect", FiducialDetect))
