"""Maps, worlds, bases, waypoints, maps of fiducials and pictures."""

import io
from contextlib import suppress
from pathlib import Path

from PIL import Image
from tests.fuzz.target import Target

from ur.robot.base import read_base
from ur.source.diagnostic import UserError
from ur.source.render import render_human
from ur.worlds.world_file import read_world
from ur_nodes.client.waypoints import WaypointStore
from ur_nodes.geometry.grid import load_map
from ur_nodes.pictures.decode import BadPictureError, decode_picture, read_size, unpack_picture
from ur_nodes.vision.fiducial_map import format_map, read_map

_PACKAGE = Path(__file__).parents[3] / "ubiquity_launches"
_CUT = b"\n====\n"  # between the YAML of a map and its image
_WORDS = (
    *(
        b"image: ",
        b"resolution: ",
        b"origin: ",
        b"negate: ",
        b"mode: scale",
        b"mode: raw",
        b"[0, 0, 0]",
        b".nan",
        b"-.inf",
    ),
    *(
        b"&a ",
        b"*a",
        b"<<: *a",
        b"!!binary ",
        b"- ",
        b"? ",
        b"---\n",
        b"floor_plan: ",
        b"pose: ",
        b"size: ",
        b"1e-300",
        b"1e300",
    ),
    *(b"P5\n", b"P2\n", b"P6 ", b"P1 ", b"Pf\n", b"255\n", b"65535\n", b"20000 20000\n", b"0 0\n", b"-1 5\n", b"# x\n"),
    *(
        b"IHDR",
        b"IDAT",
        b"PLTE",
        b"tRNS",
        b"zTXt",
        b"iCCP",
        b"GIF89a",
        b"BM",
        b"II*\x00",
        b"\xff\xd8\xff",
        b"/dev/zero",
        b"a.pgm",
    ),
)


def _load_map(data: bytes, folder: Path) -> None:
    text, _, image = data.partition(_CUT)
    path = folder / "a.yaml"
    path.write_bytes(text)
    (folder / "a.pgm").write_bytes(image)
    _tolerate(lambda: load_map(path))


def _read_world(data: bytes, folder: Path) -> None:
    path = folder / "a.yaml"
    path.write_bytes(data)
    (folder / "maze.yaml").symlink_to(_PACKAGE / "n_map_server" / "maps" / "maze.yaml")
    _tolerate(lambda: read_world(path))


def _read_base(data: bytes, folder: Path) -> None:
    path = folder / "base.yaml"
    path.write_bytes(data)
    for variant in ("", "lidar"):
        _tolerate(lambda variant=variant: read_base(path, "magni", variant))


def _read_waypoints(data: bytes, folder: Path) -> None:
    path = folder / "a.yaml"
    path.write_bytes(data)
    _tolerate(WaypointStore(path).places)


def _read_fiducials(data: bytes, folder: Path) -> None:
    path = folder / "a.txt"
    path.write_bytes(data)
    _tolerate(lambda: format_map(read_map(path)))


def _tolerate(read: object) -> None:
    assert callable(read)
    try:
        read()
    except UserError as problem:
        render_human(problem.diagnostics)


def _decode(data: bytes, _: Path) -> None:
    with suppress(BadPictureError):
        read_size(data)
    with suppress(BadPictureError):
        decode_picture(data, (80, 60))
    with suppress(BadPictureError):
        width, height, step, choice = data[:4].ljust(4, b"\x08")
        unpack_picture(data[4:], width, height, step, "rgb8" if choice < 128 else "mono8")


def _make_maps() -> list[bytes]:
    maps = []
    for mode, form in (("L", "PPM"), ("RGBA", "PNG"), ("P", "PNG"), ("I;16", "PNG"), ("1", "PPM"), ("LA", "PNG")):
        image = io.BytesIO()
        Image.new(mode, (6, 5)).save(image, form)
        text = "image: a.pgm\nresolution: 0.05\norigin: [0.0, 0.0, 0.0]\nnegate: 0\n"
        text += "occupied_thresh: 0.65\nfree_thresh: 0.196\n"
        maps += [text.encode() + _CUT + image.getvalue(), f"{text}mode: scale\n".encode() + _CUT + image.getvalue()]
    return maps


def _make_pictures() -> list[bytes]:
    pictures = []
    for form in ("PNG", "JPEG", "GIF", "TIFF", "BMP"):
        image = io.BytesIO()
        Image.new("RGB", (20, 16), (1, 2, 3)).save(image, form)
        pictures.append(image.getvalue())
    return pictures


def _read_files(*patterns: str) -> list[bytes]:
    return [path.read_bytes() for pattern in patterns for path in sorted(_PACKAGE.glob(pattern))]


TARGETS = (
    Target("map", _load_map, _WORDS, _make_maps),
    Target("world", _read_world, _WORDS, lambda: _read_files("n_simulator/worlds/*.yaml")),
    Target("base", _read_base, _WORDS, lambda: _read_files("bases/*/base.yaml")),
    Target("waypoints", _read_waypoints, _WORDS),
    Target("fiducial_map", _read_fiducials, _WORDS),
    Target("picture", _decode, _WORDS, _make_pictures),
)
