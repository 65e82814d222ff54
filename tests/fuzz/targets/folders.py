"""Folders and archives of strangers: `ur get --missing`, `ur maps import`, and what `ur maps copy` receives."""

import gzip
import io
import tarfile
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from tests.fuzz.described import CUT, WORDS, expand, make_files
from tests.fuzz.target import Target

from ur.get.folder import folder_needs
from ur.get.plan import Tables, make_plan, render_plan
from ur.maps.exchange import import_picture
from ur.maps.store import MapStore
from ur.source.diagnostic import UserError
from ur.source.foreign.archives import unpack_archive
from ur.source.render import render_human

_YAML = "image: a.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
_GET_WORDS = (
    *(b"$(find a)/b.c", b"<node pkg='a' type='b'/>", b"<name>a</name>", b"<depend>a</depend>"),
    *(b"a.launch", b"package.xml"),
)
_MAP_WORDS = (
    b"image: ",
    b"origin: ",
    b".nan",
    b"1e300",
    b"P5\n",
    b"P2\n",
    b"P6 ",
    b"8900 8900\n",
    b"map.json",
    b"a.pgm",
)


def _get(data: bytes, folder: Path) -> None:
    make_files(expand(data), folder)
    try:
        needs = folder_needs([str(folder)], {})
        render_plan(make_plan(needs.missing, Tables({}, {}), needs.is_there, needs.notes))
    except UserError as problem:
        render_human(problem.diagnostics)


def _tolerate(read: Callable[[], object]) -> None:
    try:
        read()
    except UserError as problem:
        render_human(problem.diagnostics)


def _import_map(data: bytes, folder: Path) -> None:
    made, store = folder / "made", MapStore(folder / "maps")
    made.mkdir()
    make_files(expand(data), made)
    _tolerate(lambda: import_picture(store, made / "map.yaml", "a"))
    _tolerate(lambda: import_picture(store, made, "b"))


def _unpack(data: bytes, folder: Path) -> None:
    with suppress(ValueError):
        unpack_archive(gzip.compress(expand(data), 1), folder, r"[a-z]{1,9}", files=20, size=1_000_000)


def _make_folders() -> list[bytes]:
    parts = (
        b"a.launch file\n<launch><node pkg='no_such' type='x' name='x'/>$(find other)/b.launch</launch>",
        b"p/package.xml file\n<package><name>p</name><depend>missing_one</depend></package>",
    )
    return [CUT.join(parts), *(CUT.join((parts[0], part)) for part in parts[1:])]


def _make_maps() -> list[bytes]:
    yaml, image = f"map.yaml file\n{_YAML}".encode(), b"a.pgm file\nP5\n3 2\n255\n\0\1\2\3\4\5"
    record = b'map.json file\n{"version": 1}'
    return [CUT.join((yaml, image)), CUT.join((yaml.replace(b"a.pgm", b"map.pgm"), b"map.pgm " + image[6:], record))]


def _make_archives() -> list[bytes]:
    archives = []
    for form in (tarfile.PAX_FORMAT, tarfile.GNU_FORMAT, tarfile.USTAR_FORMAT):
        buffer = io.BytesIO()
        with tarfile.open(fileobj=buffer, mode="w", format=form) as archive:
            for name in ("a", "b", *(["c" * 150] if form != tarfile.USTAR_FORMAT else [])):
                info = tarfile.TarInfo(name)
                info.size, info.mtime = 5, 1.5
                archive.addfile(info, io.BytesIO(b"12345"))
        archives.append(buffer.getvalue()[:6144])
    return archives


TARGETS = (
    Target("get", _get, (*WORDS, *_GET_WORDS), _make_folders),
    Target("map_folder", _import_map, (*WORDS, *_MAP_WORDS), _make_maps),
    Target("archive", _unpack, WORDS, _make_archives),
)
