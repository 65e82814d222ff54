import ctypes
import shutil
import subprocess
from pathlib import Path

import pytest

from ur_nodes.camera import abi, controls

STRUCTURES = {
    abi.Capability: "v4l2_capability",
    abi.FormatDescription: "v4l2_fmtdesc",
    abi.FrameSize: "v4l2_frmsizeenum",
    abi.PixelFormat: "v4l2_pix_format",
    abi.Format: "v4l2_format",
    abi.CaptureParameters: "v4l2_captureparm",
    abi.StreamParameters: "v4l2_streamparm",
    abi.BufferRequest: "v4l2_requestbuffers",
    abi.Buffer: "v4l2_buffer",
    abi.Control: "v4l2_control",
    abi.ControlQuery: "v4l2_queryctrl",
}
# Members that the kernel keeps in a structure or union of theirs.
INNER: dict[tuple[type[ctypes.Structure], str], str] = {
    (abi.CaptureParameters, "numerator"): "timeperframe.numerator",
    (abi.CaptureParameters, "denominator"): "timeperframe.denominator",
}
REQUESTS = ["QUERYCAP", "ENUM_FMT", "S_FMT", "REQBUFS", "QUERYBUF", "QBUF", "DQBUF", "STREAMON", "STREAMOFF", "S_PARM"]
REQUESTS += ["S_CTRL", "QUERYCTRL", "ENUM_FRAMESIZES"]
CONSTANTS = {
    "V4L2_BUF_TYPE_VIDEO_CAPTURE": abi.CAPTURE,
    "V4L2_MEMORY_MMAP": abi.MMAP,
    "V4L2_CAP_VIDEO_CAPTURE": abi.CAP_VIDEO_CAPTURE,
    "V4L2_CAP_STREAMING": abi.CAP_STREAMING,
    "V4L2_CAP_DEVICE_CAPS": abi.CAP_DEVICE_CAPS,
    "V4L2_FRMSIZE_TYPE_DISCRETE": abi.SIZE_DISCRETE,
    "V4L2_BUF_FLAG_ERROR": abi.BUF_ERROR,
    "V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC": abi.BUF_MONOTONIC,
    "V4L2_BUF_FLAG_TIMESTAMP_MASK": abi.BUF_TIMESTAMP_MASK,
    "V4L2_CAP_TIMEPERFRAME": abi.PARM_TIMEPERFRAME,
    "V4L2_CTRL_FLAG_DISABLED": abi.CONTROL_DISABLED,
    "V4L2_CTRL_FLAG_READ_ONLY": abi.CONTROL_READ_ONLY,
    "V4L2_CTRL_FLAG_INACTIVE": abi.CONTROL_INACTIVE,
    "V4L2_CID_BRIGHTNESS": controls.BRIGHTNESS,
    "V4L2_CID_CONTRAST": controls.CONTRAST,
    "V4L2_CID_SATURATION": controls.SATURATION,
    "V4L2_CID_SHARPNESS": controls.SHARPNESS,
    "V4L2_CID_HFLIP": controls.MIRROR,
    "V4L2_CID_VFLIP": controls.FLIP,
    "V4L2_CID_EXPOSURE_AUTO": controls.EXPOSURE_AUTO,
    "V4L2_CID_EXPOSURE_ABSOLUTE": controls.EXPOSURE_ABSOLUTE,
    "V4L2_CID_EXPOSURE_AUTO_PRIORITY": controls.EXPOSURE_DYNAMIC_RATE,
    "V4L2_CID_JPEG_COMPRESSION_QUALITY": controls.JPEG_QUALITY,
}


def list_expected() -> dict[str, int]:
    expected = dict(CONSTANTS)
    for structure, name in STRUCTURES.items():
        expected[f"sizeof(struct {name})"] = ctypes.sizeof(structure)
        for member, *_ in structure._fields_:
            inner = INNER.get((structure, member), member)
            expected[f"offsetof(struct {name}, {inner})"] = getattr(structure, member).offset
    expected |= {f"VIDIOC_{name}": getattr(abi, name) for name in REQUESTS}
    return expected


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
@pytest.mark.skipif(not Path("/usr/include/linux/videodev2.h").exists(), reason="no header of the kernel")
def test_structures_and_numbers_are_those_of_the_kernels_header(tmp_path: Path) -> None:
    expected = list_expected()
    lines = "\n".join(f'printf("%llu\\n", (unsigned long long)({each}));' for each in expected)
    source = tmp_path / "abi.c"
    source.write_text(
        "#include <stddef.h>\n#include <stdio.h>\n#include <linux/videodev2.h>\n"
        f"int main(void) {{\n{lines}\nreturn 0;\n}}\n"
    )
    subprocess.run(["cc", "-o", tmp_path / "abi", source], check=True, capture_output=True)
    found = subprocess.run([tmp_path / "abi"], check=True, capture_output=True, text=True).stdout.split()
    assert dict(zip(expected, map(int, found), strict=True)) == expected


def test_fourcc_is_read_as_it_is_written() -> None:
    assert abi.from_fourcc(abi.to_fourcc("MJPG")) == "MJPG"
    assert abi.from_fourcc(0x80000000 | abi.to_fourcc("Y16 ")) == "Y16 "  # the bit of big-endian formats
    assert abi.from_fourcc(0x1B) == "????"
