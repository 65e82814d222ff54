from __future__ import annotations

import io
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from genmsg import MsgContext, compute_md5
from genmsg.msg_loader import load_msg_from_string
from std_msgs.msg import Header

from ur_nodes.codecs.vision.fiducial_messages import message_classes


@pytest.mark.parametrize("name", ["FiducialArray", "FiducialTransformArray"])
def test_messages_that_debian_does_not_package_go_over_the_wire(name: str) -> None:
    classes: Any = message_classes(name)
    array, element = classes
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
    context = MsgContext.create_default()
    header = load_msg_from_string(context, "uint32 seq\ntime stamp\nstring frame_id\n", "std_msgs/Header")
    assert compute_md5(context, header) == Header._md5sum
    sums = {name: message_classes(name)[0]._md5sum for name in ("FiducialArray", "FiducialTransformArray")}
    assert len(set(sums.values())) == 2


def test_process_that_is_killed_leaves_no_file(tmp_path: Path) -> None:
    code = f"import os; from {message_classes.__module__} import *; message_classes('FiducialArray'); os._exit(0)"
    environment = {**os.environ, "TMPDIR": str(tmp_path)}
    subprocess.run([sys.executable, "-I", "-c", code], env=environment, check=True)
    assert list(tmp_path.iterdir()) == []
