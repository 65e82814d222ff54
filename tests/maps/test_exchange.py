import io
import tarfile
from pathlib import Path

import numpy as np
import pytest

from ur.maps.exchange import export_picture, import_picture, pack_map, unpack_map
from ur.maps.picture_file import write_picture
from ur.maps.store import MapStore
from ur.source.diagnostic import UserError
from ur.worlds.map_file import read_map

VALUES = np.array(((0, 100, -1), (100, -1, 0)), dtype=np.int8)


@pytest.fixture
def store(tmp_path: Path) -> MapStore:
    made = MapStore(tmp_path / "maps")
    import_picture(made, write_picture(tmp_path / "plan", VALUES, 0.1, (1.0, 2.0, 0.0)), "flat")
    return made


@pytest.mark.parametrize("ending", ["", ".yaml", ".png", ".pgm"])
def test_exported_map_is_the_same(ending: str, store: MapStore, tmp_path: Path) -> None:
    written = export_picture(store, "flat", tmp_path / f"out{ending}")
    assert all(path.is_file() for path in written)
    read = read_map(tmp_path / "out.yaml")
    assert np.array_equal(read.values, VALUES)
    assert read.origin == (1.0, 2.0, 0.0)


def test_packed_map_is_unpacked_and_checked(store: MapStore) -> None:
    data = pack_map(store.path("flat"))
    with store.arriving("copy") as folder:
        unpack_map(data, folder, "bob")
    assert np.array_equal(read_map(store.picture("copy")).values, VALUES)


def test_folder_of_a_map_is_imported_with_its_record(store: MapStore) -> None:
    import_picture(store, store.path("flat"), "again")
    assert store.names() == ["again", "flat"]


def pack(files: dict[str, bytes], link: str = "") -> bytes:
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as archive:
        for name, content in files.items():
            member = tarfile.TarInfo(name)
            member.size = len(content)
            archive.addfile(member, io.BytesIO(content))
        if link:
            member = tarfile.TarInfo("map.json")
            member.type, member.linkname = tarfile.SYMTYPE, link
            archive.addfile(member)
    return buffer.getvalue()


YAML = b"image: map.pgm\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n"
PICTURE = b"P5\n1 1\n255\n\0"


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"nonsense",
        pack({}),
        pack({"map.yaml": YAML}),
        pack({"map.yaml": YAML.replace(b"map.pgm", b"/etc/passwd"), "map.pgm": PICTURE}),
        pack({"map.yaml": YAML, "map.pgm": PICTURE, "../evil": b"x"}),
        pack({"map.yaml": YAML, "map.pgm": PICTURE, "map.json": b"{}"}),
        pack({"map.yaml": YAML, "map.pgm": PICTURE}, link="/etc/passwd"),
        pack({"map.yaml": YAML, "map.pgm": PICTURE, "map.json": b'{"version": 1, "graph": "graph_1.npz"}'}),
    ],
    ids=["empty", "text", "no files", "no picture", "path", "escape", "bad record", "link", "no graph"],
)
def test_archive_that_is_no_map_leaves_nothing(data: bytes, store: MapStore) -> None:
    with pytest.raises(UserError), store.arriving("copy") as folder:
        unpack_map(data, folder, "bob")
    assert [each.name for each in store.folder.iterdir()] == ["flat"]
    assert not (store.folder.parent / "evil").exists()
