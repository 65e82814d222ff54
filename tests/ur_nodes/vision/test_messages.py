from __future__ import annotations

import io

import numpy as np
import pytest
from sensor_msgs.msg import CameraInfo, CompressedImage, Image
from std_msgs.msg import Header

from ur.source.diagnostic import UserError
from ur_nodes.codecs.genpy.fiducials import message_classes
from ur_nodes.geometry.rigid import from_angles, from_pose, to_pose
from ur_nodes.rosio.geometry import pose3_of_transform, transform_message
from ur_nodes.vision.image_message import (
    make_compressed,
    make_image,
    read_camera,
    read_compressed,
    read_image,
)
from ur_nodes.vision.marker_message import make_markers

PICTURE = np.random.default_rng(0).integers(0, 255, (6, 8, 3)).astype(np.uint8)


@pytest.mark.parametrize("name", ["FiducialArray", "FiducialTransformArray"])
def test_messages_that_debian_does_not_package_go_over_the_wire(name: str) -> None:
    array, element = message_classes(name)
    assert array._type == f"fiducial_msgs/{name}"
    sent = array(Header(frame_id="raspicam"), 7, [element(fiducial_id=3)])
    sent.header.stamp.secs, sent.header.stamp.nsecs = 5, 6
    wire = io.BytesIO()
    sent.serialize(wire)
    read = array().deserialize(wire.getvalue())
    items = read.fiducials if name == "FiducialArray" else read.transforms
    assert (read.header.frame_id, read.header.stamp.secs, read.image_seq, items[0].fiducial_id) == ("raspicam", 5, 7, 3)


def test_checksums_follow_from_the_fields_as_ros_defines_it() -> None:
    # The rule is that of genmsg: Header has the checksum of std_msgs, whoever made its class.
    from genpy.dynamic import generate_dynamic

    made = generate_dynamic("std_msgs/Header", "uint32 seq\ntime stamp\nstring frame_id\n")
    assert made["std_msgs/Header"]._md5sum == Header._md5sum
    sums = {name: message_classes(name)[0]._md5sum for name in ("FiducialArray", "FiducialTransformArray")}
    assert len(set(sums.values())) == 2


@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "rgba8", "mono8"])
def test_images_are_read_in_common_encodings_with_padded_rows(encoding: str) -> None:
    channels = {"rgb8": PICTURE, "bgr8": PICTURE[..., ::-1], "mono8": PICTURE[..., :1]}.get(encoding)
    if channels is None:
        channels = np.concatenate([PICTURE, PICTURE[..., :1]], axis=2)
    rows = np.pad(channels.reshape(6, -1), ((0, 0), (0, 5)))
    message = Image(height=6, width=8, encoding=encoding, step=rows.shape[1], data=rows.tobytes())
    expected = PICTURE[..., 0] if encoding == "mono8" else PICTURE
    assert np.array_equal(read_image(message), expected)


def test_images_survive_messages() -> None:
    assert np.array_equal(read_image(make_image(PICTURE, Header())), PICTURE)
    smooth = np.full((16, 16, 3), (200, 100, 50), np.uint8)
    packed = make_compressed(smooth, Header())
    assert np.abs(read_compressed(packed).astype(int) - smooth).max() < 8  # red stays red
    assert read_compressed(packed, grey=True).shape == (16, 16)


def test_images_that_cannot_be_read_are_told() -> None:
    with pytest.raises(UserError, match="encoding 'yuv422', expected one of rgb8"):
        read_image(Image(height=1, width=1, encoding="yuv422", step=2, data=b"ab"))
    with pytest.raises(UserError, match="an image of 2 bytes"):
        read_image(Image(height=2, width=2, encoding="rgb8", step=6, data=b"ab"))
    with pytest.raises(UserError, match="expected JPEG or PNG"):
        read_compressed(CompressedImage(format="jpeg", data=b"nothing"))
    with pytest.raises(UserError, match="of 0 bytes"):
        read_compressed(CompressedImage(format="jpeg"))


def test_camera_without_calibration_is_none() -> None:
    assert read_camera(CameraInfo()) is None
    info = CameraInfo(K=[500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0], D=[0.1, 0.2, 0.0, 0.0, 0.0])
    camera = read_camera(info)
    assert camera is not None
    assert (camera.matrix[1, 1], camera.distortion.tolist()) == (510.0, [0.1, 0.2, 0.0, 0.0, 0.0])


def test_transforms_and_markers_keep_poses() -> None:
    pose = from_angles((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    assert np.allclose(from_pose(pose3_of_transform(transform_message(to_pose(pose)))), pose)
    markers = make_markers({4: pose}, {4: 0.3}, "map").markers
    assert [(each.ns, each.action) for each in markers] == [("", 3), ("fiducials", 0), ("numbers", 0)]
    assert markers[1].pose.position.z == pytest.approx(3.0)
    assert markers[2].pose.position.z == pytest.approx(3.3)
    assert {each.header.frame_id for each in markers} == {"map"}
