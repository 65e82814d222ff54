"""package.xml and CMakeLists.txt, images of disks, and messages of topics."""

from contextlib import suppress
from pathlib import Path

from tests.fuzz.target import Target

from ur.launchfile.world.packages import package_name_in
from ur.robot.image.device import read_partitions
from ur.robot.image.layout import describe_other, identify_filesystem, identify_packing
from ur.run.master.tcpros import read_frames
from ur.source.diagnostic import UserError
from ur.tools.package.cmake import put_block, write_block
from ur.tools.package.uses import add_run_dependencies, read_optional

_XML_WORDS = (
    *(b"<package>", b"</package>", b'<package format="2">', b"<name>", b"</name>", b"<export>", b"<metapackage/>"),
    *(b"<!--", b"-->", b"<!-- ur: optional a: b -->", b"<depend>a</depend>", b"<![CDATA[", b"]]>", b"<!DOCTYPE a ["),
    *(
        b"<!ENTITY a '&b;&b;'>]>",
        b"&a;",
        b"<?xml version='1.0' encoding='utf-16'?>",
        b"encoding='x'",
        b"# End of what is",
    ),
)
_BINARY_WORDS = (
    *(b"\x55\xaa", b"EFI PART", b"\xee", b"\x05", b"\x0f", b"\x53\xef", b"FAT", b"\x7fELF\x02\x01", b"\x7fELF\x01\x02"),
    *(b"\xff\xff\xff\xff", b"\x00" * 16, b"\xff" * 8, b"\x01\x00\x00\x00", b"\x45\x4c\x49\x46", b"KDMV", b"\x80"),
)


def _read_package(data: bytes, _: Path) -> None:
    with suppress(ValueError):
        package_name_in("package.xml", data)
    text = data.decode(errors="replace")
    read_optional(text)
    with suppress(ValueError):
        add_run_dependencies(text, ["roscpp", "rospy"])
    block = write_block(["launch"])
    assert put_block(put_block(text, block), block).count(block) >= 1


def _read_image(data: bytes, _: Path) -> None:
    def read(offset: int, count: int) -> bytes:
        assert count <= 8 << 20, "reads more than the whole table"
        return data[offset : offset + count]

    size = max(len(data), 1 << 30)
    with suppress(UserError):
        for partition in read_partitions(read, size):
            identify_filesystem(read, partition.start)
    identify_filesystem(read, 0)
    identify_packing(data)
    describe_other(read)


def _read_messages(data: bytes, _: Path) -> None:
    read_frames(data)


def _make_image() -> list[bytes]:
    record = bytearray(512)
    record[446:462] = b"\x80\x00\x00\x00\x0c\x00\x00\x00\x01\x00\x00\x00\x02\x00\x00\x00"
    record[462:478] = b"\x00\x00\x00\x00\x05\x00\x00\x00\x03\x00\x00\x00\x02\x00\x00\x00"
    record[510:] = b"\x55\xaa"
    return [bytes(record) * 6, bytes(1024 + 56) + b"\x53\xef" + bytes(500)]


def _make_messages() -> list[bytes]:
    frames = b"\x03\x00\x00\x00map\x04\x00\x00\x00odom"
    tf = b"\x01\x00\x00\x00" + bytes(12) + frames + bytes(56)
    core = b"\x7fELF\x02\x01" + bytes(26) + b"\x40" + bytes(21) + b"\x38\x00\x02\x00" + bytes(6)
    note = b"\x04\x00\x00\x00" + bytes(4) + b"\xb0" + bytes(23) + b"\x40" + bytes(23)
    body = b"\x05\x00\x00\x00\x10\x00\x00\x00\x45\x4c\x49\x46CORE\x00\x00\x00\x00/usr/bin/a\x00" + bytes(32)
    return [tf, core + note * 2 + body]


TARGETS = (
    Target("package_xml", _read_package, _XML_WORDS),
    Target("partitions", _read_image, _BINARY_WORDS, _make_image),
    Target("messages", _read_messages, _BINARY_WORDS, _make_messages),
)
