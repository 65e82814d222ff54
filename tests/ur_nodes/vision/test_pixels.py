import struct
import zlib

import cv2
import numpy as np
import pytest

from ur_nodes.pictures.decode import BadPictureError, make_picture
from ur_nodes.ports.values import PackedPicture, Picture
from ur_nodes.vision.fiducial_detect import pack_picture, read_pixels

PICTURE = np.random.default_rng(0).integers(0, 255, (6, 8, 3)).astype(np.uint8)


def test_pictures_survive_their_messages() -> None:
    assert np.array_equal(read_pixels(make_picture(PICTURE, 0, "camera")), PICTURE)
    smooth = np.full((16, 16, 3), (200, 100, 50), np.uint8)
    packed = pack_picture(smooth, 0, "camera")
    assert np.abs(read_pixels(packed).astype(int) - smooth).max() < 8  # red stays red
    assert read_pixels(packed, grey=True).shape == (16, 16)


def test_pictures_that_cannot_be_read_are_refused() -> None:
    with pytest.raises(BadPictureError, match="encoding 'yuv422'; expected one of rgb8"):
        read_pixels(Picture(0, "camera", 1, 1, "yuv422", 2, b"ab"))
    with pytest.raises(BadPictureError, match=r"of 7 bytes .'jpeg'., expected JPEG or PNG"):
        read_pixels(PackedPicture(0, "camera", "jpeg", b"nothing"))
    with pytest.raises(BadPictureError, match="of 0 bytes"):
        read_pixels(PackedPicture(0, "camera", "jpeg", b""))
    with pytest.raises(BadPictureError, match="0 bytes, 0 x 0"):
        read_pixels(Picture(0, "camera", 0, 0, "rgb8", 0, b""))


def test_packed_picture_with_more_pixels_than_opencv_allows_is_refused() -> None:
    small = cv2.imencode(".png", PICTURE)[1].tobytes()
    head = small[12:16] + struct.pack(">II", 100_000, 100_000) + small[24:29]
    png = small[:12] + head + struct.pack(">I", zlib.crc32(head)) + small[33:]
    with pytest.raises(BadPictureError, match="expected JPEG or PNG"):
        read_pixels(PackedPicture(0, "camera", "png", png))
