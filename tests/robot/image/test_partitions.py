import struct
from pathlib import Path

import pytest
from tests.robot.image.images import MIB, Part, make_image, needs_tools, run

from ur.robot.image.device import Partition, read_partitions
from ur.robot.image.layout import open_reader
from ur.source.diagnostic import UserError


def read(path: Path) -> tuple[Partition, ...]:
    with open_reader(path) as (reader, size):
        return read_partitions(reader, size)


@needs_tools
@pytest.mark.parametrize("table", ["dos", "gpt"])
def test_partitions_of_both_tables_are_found_where_sfdisk_put_them(tmp_path: Path, table: str) -> None:
    image = make_image(tmp_path / "x.img", [Part("none", size=2), Part("none", size=3)], table)  # type: ignore[arg-type] # parametrized
    assert read(image) == (Partition(1, MIB, 2 * MIB), Partition(2, 3 * MIB, 3 * MIB))


@needs_tools
def test_logical_partitions_have_the_numbers_of_the_kernel(tmp_path: Path) -> None:
    image = tmp_path / "x.img"
    with image.open("wb") as file:
        file.truncate(16 * MIB)
    rows = "label: dos\n1: start=1MiB, size=2MiB, type=c\n2: start=3MiB, size=12MiB, type=5\n"
    run(
        "sfdisk",
        "--quiet",
        str(image),
        stdin=rows + "5: start=4MiB, size=2MiB, type=83\n6: start=8MiB, size=3MiB, type=83\n",
    )
    assert read(image) == (
        Partition(1, MIB, 2 * MIB),
        Partition(5, 4 * MIB, 2 * MIB),
        Partition(6, 8 * MIB, 3 * MIB),
    )


@needs_tools
def test_image_that_was_cut_off_is_named_with_what_is_missing(tmp_path: Path) -> None:
    image = make_image(tmp_path / "x.img", [Part("none", size=2), Part("none", size=3)])
    with image.open("r+b") as file:
        file.truncate(4 * MIB)
    with pytest.raises(UserError, match=rf"ends \({4 * MIB} bytes\) before its partition 2"):
        read(image)


@needs_tools
@pytest.mark.parametrize("place", [512 + 24, 1024 + 40])
def test_changed_byte_of_gpt_is_noticed(tmp_path: Path, place: int) -> None:
    image = make_image(tmp_path / "x.img", [Part("none", size=2)], "gpt")
    with image.open("r+b") as file:
        file.seek(place)
        byte = file.read(1)
        file.seek(place)
        file.write(bytes([byte[0] ^ 1]))
    with pytest.raises(UserError, match="checksum"):
        read(image)


def test_circle_of_extended_records_ends(tmp_path: Path) -> None:
    record = bytearray(512)
    record[510:] = b"\x55\xaa"
    struct.pack_into("<B3xB3xII", record, 446, 0, 5, 1, 8)
    circle = bytearray(512)
    circle[510:] = b"\x55\xaa"
    struct.pack_into("<B3xB3xII", circle, 446, 0, 0x83, 1, 1)
    struct.pack_into("<B3xB3xII", circle, 462, 0, 5, 0, 8)
    image = tmp_path / "x.img"
    image.write_bytes(bytes(record) + bytes(circle) + bytes(4096))
    assert len(read(image)) == 60


def test_file_without_a_table_has_no_partitions(tmp_path: Path) -> None:
    for content in (b"", b"\x55\xaa", bytes(512), b"x" * 510 + b"\x55\xaa"):
        image = tmp_path / "x.img"
        image.write_bytes(content)
        assert read(image) == ()
