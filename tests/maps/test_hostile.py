"""Maps of strangers: special files and sizes are refused before they are read."""

import io
import os
import tarfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from tests.fakes.pictures import make_png

from ur.maps.exchange import import_picture, pack_map, unpack_map
from ur.maps.picture_file import write_picture
from ur.maps.store import MapStore
from ur.source.diagnostic import UserError

SETTINGS = "resolution: 0.05\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"


@pytest.mark.parametrize(
    ("make", "reason"),
    [
        (os.mkfifo, "not a regular file"),
        (lambda path: path.symlink_to("/dev/zero"), "not a regular file"),
        (Path.mkdir, "not a regular file"),
        (lambda path: path.write_bytes(make_png(8900, 8900, 16, 6)), "316,840,000 bytes"),
        (lambda path: path.write_bytes(b"P5\n#" + b"x" * 30_000_000 + b"\n1 1\n255\n\0"), "comments"),
        (lambda path: path.write_bytes(b"P5\n8000 8000\n255\n"), "truncated|damaged|not enough"),
        (lambda path: os.truncate(os.open(path, os.O_CREAT | os.O_WRONLY), 1 << 40), "larger than"),
    ],
)
def test_image_of_a_map_is_refused(tmp_path: Path, make: Callable[[Path], None], reason: str) -> None:
    make(tmp_path / "image")
    (tmp_path / "map.yaml").write_text(f"image: image\norigin: [0, 0, 0]\n{SETTINGS}")
    with pytest.raises(UserError, match=reason):
        import_picture(MapStore(tmp_path / "maps"), tmp_path / "map.yaml", "a")
    assert not (tmp_path / "maps" / "a").exists()


@pytest.mark.parametrize(
    "origin", ["[.nan, 0, 0]", "[0, -.inf, 0]", "[0, 0, .inf]", "[1e300, 0, 0]", f"[{'9' * 400}, 0, 0]"]
)
def test_origin_that_is_no_place_is_refused(tmp_path: Path, origin: str) -> None:
    (tmp_path / "image").write_bytes(b"P5\n1 1\n255\n\0")
    (tmp_path / "map.yaml").write_text(f"image: image\norigin: {origin}\n{SETTINGS}")
    with pytest.raises(UserError, match="origin"):
        import_picture(MapStore(tmp_path / "maps"), tmp_path / "map.yaml", "a")


@pytest.mark.parametrize("resolution", [".nan", ".inf", "1e-300", "1e300", "0"])
def test_resolution_that_is_no_length_is_refused(tmp_path: Path, resolution: str) -> None:
    (tmp_path / "image").write_bytes(b"P5\n1 1\n255\n\0")
    settings = SETTINGS.replace("0.05", resolution)
    (tmp_path / "map.yaml").write_text(f"image: image\norigin: [0, 0, 0]\n{settings}")
    with pytest.raises(UserError, match="resolution"):
        import_picture(MapStore(tmp_path / "maps"), tmp_path / "map.yaml", "a")


@pytest.mark.parametrize("image", ["/dev/zero", "../pipe", "pipe", "map_2.pgm"])
def test_image_outside_of_a_received_map_is_not_opened(tmp_path: Path, image: str) -> None:
    (tmp_path / "f").mkdir()
    os.mkfifo(tmp_path / "pipe")
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as archive:
        text = f"image: {image}\norigin: [0, 0, 0]\n{SETTINGS}".encode()
        info = tarfile.TarInfo("map.yaml")
        info.size = len(text)
        archive.addfile(info, io.BytesIO(text))
    with pytest.raises(UserError, match=r"its picture is|missing"):
        unpack_map(buffer.getvalue(), tmp_path / "f", "bob")


def test_floor_plan_of_a_received_map_is_not_followed(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "plan.yaml")
    (tmp_path / "map").mkdir()
    (tmp_path / "map" / "map.yaml").write_text("floor_plan: ../plan.yaml\n")
    with pytest.raises(UserError, match="image is missing"):
        import_picture(MapStore(tmp_path / "maps"), tmp_path / "map", "a")


@pytest.mark.parametrize("make", [os.mkfifo, lambda path: path.symlink_to("/etc/passwd")])
def test_folder_of_a_map_with_other_files_is_refused(tmp_path: Path, make: Callable[[Path], None]) -> None:
    store = MapStore(tmp_path / "maps")
    import_picture(store, write_picture(tmp_path / "plan", np.zeros((2, 2), np.int8), 0.1, (0.0, 0.0, 0.0)), "flat")
    assert pack_map(store.path("flat"))
    (tmp_path / "map").mkdir()
    make(tmp_path / "map" / "map.yaml")
    with pytest.raises(UserError, match=r"not a regular file|outside of the folder"):
        import_picture(store, tmp_path / "map", "a")
