"""Import and export of maps: checked before they become maps of the store, and packed for another computer."""

import io
import re
import tarfile
from pathlib import Path

from ur.maps.picture_file import describe_picture, shades, write_picture
from ur.maps.record import read_record
from ur.maps.scan_file import read_graph, read_scans
from ur.maps.store import PICTURE, MapStore
from ur.maps.zones import draw_masks
from ur.source.diagnostic import UserError, user_error
from ur.source.foreign.archives import unpack_archive
from ur.source.foreign.files import read_file, refuse_file
from ur.source.foreign.pictures import MAP_FORMATS, open_picture
from ur.source.replace import check_output, replace_file
from ur.source.section import read_section
from ur.worlds.map_file import MapImage, parse_map_file, read_map, read_map_section

MOST_PACKED = 45_000_000  # bytes; as text they are less than an answer over ssh may have
_MOST_UNPACKED = 400_000_000
_MOST_PART = 100_000_000
_GREY = 205
_GREY_DARKNESS = (255 - _GREY) / 255
_MOST_FILES = 1100
_FILE = re.compile(r"map\.json|map\.yaml|map(_2)?\.pgm|(graph|scans)_[0-9]{1,6}\.npz")


def pack_map(folder: Path) -> bytes:
    """Pack the files of a map, which must not change meanwhile. Raises OSError, or UserError if it is too large."""
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w:gz") as archive:
        for path in sorted(folder.iterdir()):
            if _FILE.fullmatch(path.name):
                archive.add(path, path.name, recursive=False)
    if buffer.tell() > MOST_PACKED:
        message = f"map {folder.name!r} is larger than {MOST_PACKED // 1_000_000} MB, expected a smaller one"
        raise user_error(message, rule="bad-map", help="export its picture: ur maps export")
    return buffer.getvalue()


def unpack_map(data: bytes, folder: Path, place: str) -> None:
    """Unpack a map into an empty folder and check every file of it.

    `place` names its origin. Raises UserError for files that do not belong to a map, or an invalid one.
    """
    try:
        unpack_archive(data, folder, _FILE.pattern, files=_MOST_FILES, size=_MOST_UNPACKED)
    except ValueError as problem:
        raise _not_a_map(place, str(problem)[:80]) from None
    check_map(folder, place)
    draw_masks(folder)


def check_map(folder: Path, place: str) -> None:
    """Read every file of a map. Raises UserError."""
    file = folder / PICTURE
    if not file.is_file():
        raise _not_a_map(place, f"the folder holds no {PICTURE}", "give the file NAME.yaml of a map")
    section = read_section(file, "a map file", piped=False)
    image = parse_map_file(section, folder).image
    if image.parent != folder or not _FILE.fullmatch(image.name):
        raise _not_a_map(place, f"its picture is {image.name!r}, expected map.pgm")
    read_map_section(section, folder, inside=folder)
    record = read_record(folder)
    if record.graph:
        count = len(read_graph(folder / record.graph).poses)
        if sum(len(read_scans(folder / name)) for name in record.scans) < count:
            raise _not_a_map(place, "it has fewer scans than keyframes")


def import_picture(store: MapStore, source: Path, name: str) -> MapImage:
    """Import a map from a map_server YAML file, or from the folder of a map.

    Raises UserError if the file is invalid, or the name is taken.
    """
    if source.is_dir():
        with store.arriving(name) as folder:
            for path in sorted(source.iterdir()):
                if _FILE.fullmatch(path.name):
                    replace_file(folder / path.name, _read_part(path, source))
            check_map(folder, f"'{source}'")
            draw_masks(folder)
        return read_map(store.picture(name))
    image = read_map(source)
    with store.arriving(name) as folder:
        write_picture(folder / "map", image.values, image.resolution, image.origin)
    return image


def treats_grey_as_free(image: MapImage) -> bool:
    """Return whether an imported picture has map_server's grey of unknown floor, and its thresholds make that free."""
    file = image.file
    if file.mode != "trinary" or file.negate or file.free_thresh <= _GREY_DARKNESS:
        return False
    with open_picture(file.image, MAP_FORMATS) as picture:
        return picture.mode in ("L", "P", "RGB") and bool(picture.convert("L").histogram()[_GREY])


def export_picture(store: MapStore, name: str, target: Path) -> list[Path]:
    """Write the picture of a map as `target`.yaml and `target`.png (or .pgm, by the ending of `target`).

    Return the files. Raises UserError if the map does not exist or is damaged, or an output is; or OSError.
    """
    from PIL import Image

    stored = store.picture(store.resolve(name))
    image = read_map(stored)
    stem = target.with_suffix("") if target.suffix in (".yaml", ".png", ".pgm") else target
    for ending, begin in ((".yaml", b"image:"), (".png", b"\x89PNG"), (".pgm", b"P5"), ("_2.pgm", b"P5")):
        check_output(stem.with_name(f"{stem.name}{ending}"), stored.parent.iterdir(), begin)
    if target.suffix == ".pgm":
        file = write_picture(stem, image.values, image.resolution, image.origin)
        return [file, stem.with_name(f"{stem.name}.pgm")]
    buffer = io.BytesIO()
    Image.fromarray(shades(image.values)).save(buffer, "PNG")
    picture, file = stem.with_name(f"{stem.name}.png"), stem.with_name(f"{stem.name}.yaml")
    replace_file(picture, buffer.getvalue(), parents=True)
    replace_file(file, describe_picture(picture.name, image.resolution, image.origin))
    return [file, picture]


def _read_part(path: Path, folder: Path) -> bytes:
    try:
        return read_file(path, _MOST_PART, inside=folder)
    except OSError as problem:
        raise refuse_file(path, problem, "a file of a map") from None


def _not_a_map(place: str, what: str, help_: str = "copy it again") -> UserError:
    message = f"{place} is not a map that can be used: {what}"
    return user_error(message, rule="bad-map", help=help_, subject=place)
